"""The channel's transfer function against numerical solutions of its equations, linear and nonlinear."""

import numpy as np
import pytest

from examples.open_channel import BETWEEN, FREQUENCIES, MEASURED, OpenChannel, delay_free_responses
from examples.open_channel_numerics import TimeStepping, integrated_response
from identification.errors import RangeError

CHANNEL = OpenChannel()
POSITIONS = np.sort([0.0, *MEASURED, *BETWEEN, 15500.0])


@pytest.mark.parametrize("omega", [1e-4, 1e-3, 7e-3, 5e-2])
def test_it_solves_the_linear_equations(omega):
    found = np.array([CHANNEL.response(x, [omega])[0, 0] for x in POSITIONS])
    integrated = integrated_response(CHANNEL, POSITIONS, omega)
    assert np.allclose(found, integrated, rtol=1e-8, atol=1e-8 * abs(integrated).max())


@pytest.mark.parametrize("entering", [True, False])
@pytest.mark.parametrize("omega", [4e-4, 2e-3])
def test_small_waves_of_the_nonlinear_equations_follow_it(omega, entering):
    stepping = TimeStepping(CHANNEL, cells=100, steps_per_period=150, periods=5)
    simulated = stepping.response(omega, entering)
    x = np.linspace(0, CHANNEL.length, stepping.cells + 1)
    expected = np.array([CHANNEL.response(p, [omega])[0, 0, 0 if entering else 1] for p in x])
    assert np.linalg.norm(simulated - expected) < 5e-3 * np.linalg.norm(expected)


def test_it_fills_like_a_basin_at_low_frequency():
    omega = 1e-7
    mean = np.mean([CHANNEL.response(x, [omega])[0, 0] for x in np.linspace(0, CHANNEL.length, 2001)], axis=0)
    basin = 1 / (1j * omega * CHANNEL.surface_width * CHANNEL.length)
    assert np.allclose(mean, [basin, -basin], rtol=1e-3)


def test_the_delays_are_those_of_the_fastest_waves():
    """At high frequency λ = s/(speed of the wave) plus a constant."""
    x, omega = 4000.0, 50.0
    first, second = CHANNEL.exponents(1j * np.array([omega, 2 * omega]))
    slownesses = np.array([-(second[1] - second[0]), first[1] - first[0]]) / (1j * omega)
    assert np.allclose(slownesses * [x, CHANNEL.length - x], CHANNEL.delays(x), rtol=1e-6)
    ratio = CHANNEL.response(x, [1e-2], without_delays=True) / CHANNEL.response(x, [1e-2])
    assert np.allclose(ratio[0, 0], np.exp(1e-2j * np.array(CHANNEL.delays(x))))


def test_the_uniform_flow_obeys_manning():
    assert CHANNEL.normal_discharge(CHANNEL.depth) == pytest.approx(1400.0)
    assert 0.5 < CHANNEL.velocity < 3
    assert CHANNEL.velocity < CHANNEL.celerity


def test_responses_of_the_paper():
    data = delay_free_responses(CHANNEL)
    assert [d.operating_point for d in data] == [(x,) for x in MEASURED]
    assert all(d.matrices.shape == (250, 1, 2) for d in data)
    assert np.array_equal(data[0].frequencies, FREQUENCIES)


def test_senseless_requests_are_refused():
    with pytest.raises(RangeError, match="outside the channel"):
        CHANNEL.response(16000.0, [1e-3])
    with pytest.raises(RangeError, match="integrates"):
        CHANNEL.response(100.0, [0.0])
    with pytest.raises(RangeError, match="subcritical"):
        _ = OpenChannel(bed_slope=0.02).celerity
