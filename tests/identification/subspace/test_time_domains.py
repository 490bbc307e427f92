"""Continuous time: the bilinear map, the turned circle, the zero-order hold and back."""

import control
import numpy as np
import pytest

from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.models.system import StateSpace
from identification.signals import FrequencyResponse
from identification.subspace.domain import Domain
from identification.subspace.frequency_subspace import FrequencySubspace
from identification.subspace.time_domains import from_bilinear, from_hold, from_turned, held
from tests.support.state_space import exact, noisy, random_system, relative_error, wide_system

OMEGA = np.geomspace(0.01, 3.0, 60)


def test_the_hold_is_that_of_the_control_package():
    plant = wide_system(np.random.default_rng(0), 5, 2, 2, 0.1, 10.0)
    theirs = control.ss(plant.a, plant.b, plant.c, plant.d).sample(0.2, "zoh")
    ours = held(plant, 0.2)
    assert np.allclose(ours.a, theirs.A)
    assert np.allclose(ours.b, theirs.B)
    back = from_hold(ours)
    assert back.sample_time is None
    assert relative_error(back, plant, OMEGA) < 1e-10


def test_the_bilinear_map_keeps_the_response_at_prewarped_frequencies():
    model = random_system(np.random.default_rng(1), 4, 2, 3, 1.0)
    continuous = from_bilinear(model, 2.5)
    assert continuous.stable
    warped = 2.5 * np.tan(OMEGA / 2)
    assert np.allclose(continuous.frequency_response(warped), model.frequency_response(OMEGA))


@pytest.mark.parametrize("turn", [-0.8, 0.3, 0.95])
def test_the_turned_circle_keeps_the_response(turn):
    model = random_system(np.random.default_rng(2), 4, 2, 3, 1.0)
    z = np.exp(1j * OMEGA)
    turned = from_turned(model, turn)
    assert turned.stable
    theirs = model.frequency_response(np.angle((z - turn) / (1 - turn * z)))
    assert np.allclose(turned.frequency_response(OMEGA), theirs)


@pytest.mark.parametrize("sample_time", [None, 0.01])
def test_the_centre_lies_a_quarter_turn_round(sample_time):
    data = FrequencyResponse([0.5, 3.0, 20.0], [1.0, 1.0, 1.0], (0.0,), sample_time)
    for centre, line in ((None, 1), (20.0, 2)):
        z = Domain.of(data, False, centre).z
        assert np.allclose(abs(z), 1)
        assert z[line] == pytest.approx(1j)


def test_evenly_spread_lines_stay_where_they_are():
    data = FrequencyResponse(np.linspace(0, np.pi, 40), np.ones(40), (0.0,), 1.0)
    assert np.array_equal(Domain.of(data, False, None).z, np.exp(1j * data.frequencies))


def test_behind_a_zero_order_hold():
    plant = wide_system(np.random.default_rng(3), 4, 2, 2, 0.1, 10.0)
    sampled = exact(held(plant, 0.2), np.linspace(0.1, 15.0, 40))
    estimate = FrequencySubspace(order=4, zero_order_hold=True).estimate(sampled)
    assert estimate.model.sample_time is None
    assert relative_error(estimate.model, plant, OMEGA) < 1e-8
    assert estimate.rms_error < 1e-10


def test_continuous_time_with_noise():
    plant = wide_system(np.random.default_rng(4), 6, 1, 2, 0.01, 100.0)
    omega = np.geomspace(0.01, 100.0, 300)
    data = noisy(plant, omega, 0.01 * abs(plant.frequency_response(omega)).max(axis=(1, 2)), np.random.default_rng(5))
    model = FrequencySubspace(order=6).estimate(data).model
    between = np.geomspace(0.011, 99.0, 400)
    truth = plant.frequency_response(between)
    assert np.sqrt(np.mean(abs(model.frequency_response(between) - truth) ** 2 / abs(truth) ** 2)) < 0.03


def test_misuse():
    with pytest.raises(MisuseError, match="no zero-order hold"):
        FrequencySubspace(order=1, zero_order_hold=True).estimate(FrequencyResponse([1, 2, 3, 4], [1, 2, 3, 4], (0.0,)))
    with pytest.raises(RangeError, match="negative real axis"):
        from_hold(StateSpace([[-0.5]], [[1.0]], [[1.0]], [[0.0]], 1.0))
    with pytest.raises(NotIdentifiableError, match="infinite frequency"):
        from_bilinear(StateSpace([[-1.0]], [[1.0]], [[1.0]], [[0.0]], 1.0), 1.0)
