"""McKelvey 1: its frequencies, sizes, the structure of order 42, and misuse."""

import numpy as np
import pytest

from benchmarks.subspace_structure import compare, orders_of, picture
from examples.lightly_damped_structure import response, structure
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.signals import FrequencyResponse
from identification.subspace.equidistant_subspace import EquidistantSubspace
from tests.support.state_space import exact, random_system, relative_error, wide_system


def circle(count):
    return np.pi * np.arange(count) / (count - 1)


def test_the_structure_is_what_it_says():
    plant = structure()
    assert plant.order == 42
    assert plant.stable
    damping = -np.log(abs(plant.poles)) / abs(np.log(plant.poles))
    assert np.all((damping > 0.0039) & (damping < 0.0151))
    data = response()
    assert len(data) == 512
    assert data.frequencies[-1] == pytest.approx(np.pi * 200)


def test_four_methods_on_the_lightly_damped_structure():
    data = response()
    rows, models = compare(data)
    found = {row["method"]: row for row in rows}
    noise = np.sqrt(data.variance[0])
    assert all(row["stable"] for row in rows)
    best = found["Gauss–Newton from Levy"]
    assert best["rms"] < noise
    for name in ("McKelvey 1", "McKelvey 2"):
        assert found[name]["rms"] < 1.05 * best["rms"]
        assert found[name]["heldOutRms"] < 1.5 * noise
    assert found["Levy"]["rms"] > 10 * best["rms"]
    orders = orders_of(data, 46)
    assert orders["chosen"] == {"McKelvey 1": 42, "McKelvey 2": 42, "singular values": 42}
    assert len(picture(data, models, orders).data) == 3 + 5 + 2


def test_continuous_time_on_prewarped_frequencies():
    plant = wide_system(np.random.default_rng(1), 4, 2, 1, 0.1, 10.0)
    omega = 2.0 * np.tan(np.pi * np.arange(20) / 39)
    estimate = EquidistantSubspace(order=4).estimate(exact(plant, omega))
    assert estimate.model.sample_time is None
    assert relative_error(estimate.model, plant, np.geomspace(0.1, 10, 100)) < 1e-9


@pytest.mark.parametrize(
    ("method", "count", "error", "field"),
    [
        (EquidistantSubspace(order=4, block_rows=4), 30, RangeError, "block_rows"),
        (EquidistantSubspace(order=4, block_columns=3), 30, RangeError, "block_columns"),
        (EquidistantSubspace(order=4, block_rows=10, block_columns=10), 10, NotIdentifiableError, "frequencies"),
        (EquidistantSubspace(order=4, block_rows=10, block_columns=9), 10, NotIdentifiableError, "frequencies"),
        (EquidistantSubspace(order=4), 4, NotIdentifiableError, "frequencies"),
        (EquidistantSubspace(order=4, block_rows=59), 30, NotIdentifiableError, "frequencies"),
    ],
)
def test_sizes(method, count, error, field):
    system = random_system(np.random.default_rng(0), 4, 1, 1, 1.0)
    with pytest.raises(error) as raised:
        method.estimate(exact(system, circle(count)))
    assert raised.value.field == field


def test_other_frequencies_are_refused():
    system = random_system(np.random.default_rng(0), 2, 1, 1, 1.0)
    with pytest.raises(MisuseError, match="begin at zero"):
        EquidistantSubspace(order=2).estimate(exact(system, np.linspace(0.1, np.pi, 30)))
    for omega in (np.linspace(0, 3, 30), np.sort(np.append(np.random.default_rng(0).uniform(0, np.pi, 29), 0.0))):
        with pytest.raises(RangeError, match="equidistant"):
            EquidistantSubspace(order=2).estimate(exact(system, omega))


def test_noise_of_the_lines_weights_b_and_d():
    g = np.random.default_rng(2)
    system = random_system(g, 2, 1, 1, 1.0)
    omega = circle(200)
    truth = system.frequency_response(omega)
    sigma = np.where(omega > 2, 1.0, 1e-3)[:, None, None] * np.ones(truth.shape)
    data = FrequencyResponse(omega, truth + sigma * g.standard_normal(truth.shape), (0.0,), 1.0, sigma**2)
    method = EquidistantSubspace(order=2, block_rows=10, block_columns=10)
    below = np.linspace(0.01, 2, 50)
    equal = EquidistantSubspace(order=2, block_rows=10, block_columns=10, weighting="equal")
    assert relative_error(method.estimate(data).model, system, below) < relative_error(
        equal.estimate(data).model, system, below
    )
