"""Very many lines are compressed block by block, with the same result."""

import numpy as np
import pytest

from identification.signals import FrequencyResponse
from identification.subspace import observability, streaming
from identification.subspace.frequency_subspace import FrequencySubspace
from tests.support.state_space import exact, noisy, random_system, relative_error

BETWEEN = np.linspace(0.001, 3.14, 300)


@pytest.fixture
def in_blocks(monkeypatch):
    monkeypatch.setattr(observability, "MANY", 0)
    monkeypatch.setattr(streaming, "NUMBERS", 2000)
    monkeypatch.setattr(streaming, "REPRESENTATIVE", 300)


def data_of(noise):
    g = np.random.default_rng(1)
    system = random_system(g, 4, 2, 3, 1.0)
    omega = np.sort(g.uniform(0.05, 3.1, 1000))
    data = noisy(system, omega, 0.05 * np.exp(omega) if noise == "unequal" else np.full(1000, 0.05), g)
    if noise == "correlated":
        root = 0.05 * (g.standard_normal((1000, 6, 9)) + 1j * g.standard_normal((1000, 6, 9)))
        covariance = root @ root.conj().swapaxes(1, 2)
        data = FrequencyResponse(omega, data.response, (0.0,), 1.0, covariance=covariance)
    return data


@pytest.mark.parametrize(
    ("noise", "weighting"),
    [("equal", "equal"), ("unequal", "variance"), ("unequal", "none"), ("correlated", "variance")],
)
def test_blocks_give_the_same_model(noise, weighting, monkeypatch):
    data = data_of(noise)
    method = FrequencySubspace(order=4, block_rows=7, weighting=weighting)
    whole = method.estimate(data)
    monkeypatch.setattr(observability, "MANY", 0)
    monkeypatch.setattr(streaming, "NUMBERS", 2000)
    blocks = method.estimate(data)
    assert relative_error(blocks.model, whole.model, BETWEEN) < 1e-8
    assert blocks.singular_values == pytest.approx(whole.singular_values, rel=1e-8)


@pytest.mark.usefixtures("in_blocks")
@pytest.mark.parametrize("order", [1, 5, 12])
def test_blocks_are_exact(order):
    g = np.random.default_rng(order)
    system = random_system(g, order, 2, 2, 1.0)
    data = exact(system, np.sort(g.uniform(0.01, 3.1, 2000)))
    model = FrequencySubspace(order=order).estimate(data).model
    assert relative_error(model, system, BETWEEN) < 1e-9


@pytest.mark.usefixtures("in_blocks")
def test_blocks_are_kept_stable():
    assert FrequencySubspace(order=6, stability="maciejowski").estimate(data_of("unequal")).model.stable
