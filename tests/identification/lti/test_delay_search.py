"""Delays of many turns, on any grid, in bounded memory; what they cannot be told from is said."""

import tracemalloc

import numpy as np
import pytest

from identification.lti.delay_search import aliases, common_divisor
from identification.lti.rational_fit import RationalFit
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse

FIRST = RationalStructure(1, 0, delay=True)
T = 10.0


def fitted(omega, tau, structure=FIRST, plant=lambda s: 1 / (1 + s), seed=1):
    generator = np.random.default_rng(seed)
    exact = plant(1j * omega) * np.exp(-1j * omega * tau)
    sigma = 0.01 * abs(exact)
    noise = generator.standard_normal(len(omega)) + 1j * generator.standard_normal(len(omega))
    return RationalFit().estimate(
        structure, FrequencyResponse(omega, exact + sigma * noise / np.sqrt(2), (0.0,), None, sigma**2)
    )


@pytest.mark.parametrize("tau", [1.0, 2.6, 3.0, 4.0])
def test_odd_lines_give_the_delay_and_say_what_it_is_confused_with(tau):
    found = fitted(2 * np.pi * np.arange(1, 60, 2) / T, tau)
    assert found.outcome.ok
    assert found.tests[0].p_value > 1e-3
    _, gain, delay = found.model.zeta
    # a turn and a half over the grid of odd lines turn the sign of the gain
    assert np.exp(1j * 2 * np.pi * (delay - tau) / T) * np.sign(gain) == pytest.approx(1, abs=0.02)
    assert "10 s fits alike" in found.outcome.advice
    assert "5 s with the opposite sign of the gain" in found.outcome.advice


@pytest.mark.parametrize("tau", [1.0, 4.0, 6.0, 8.0])
def test_every_line_of_a_grid_gives_delays_up_to_its_alias(tau):
    found = fitted(2 * np.pi * np.arange(1, 101) / T, tau)
    assert found.model.zeta[-1] == pytest.approx(tau, abs=1e-3)
    assert "opposite" not in found.outcome.advice


@pytest.mark.parametrize("tau", [3.0, 20.0, 60.0])
def test_a_logarithmic_sweep_has_no_alias_and_its_next_best_delay_is_stated(tau):
    found = fitted(2 * np.pi * np.geomspace(0.01, 1, 40), tau)
    assert found.model.zeta[-1] == pytest.approx(tau, abs=0.02)
    assert "next best delay" in found.outcome.advice
    assert "alike" not in found.outcome.advice


@pytest.mark.parametrize("apart", [1e-4, 1e-9])
def test_frequencies_that_differ_in_the_last_digit_cost_no_memory(apart):
    sweep = np.logspace(-2, 2, 40)

    def plant(s):
        return (2 + 0.3 * s) / (s**2 + 0.4 * s + 4)

    tracemalloc.start()
    found = fitted(np.sort(np.r_[sweep, sweep * (1 - apart)]), 0.05, RationalStructure(2, 1, delay=True), plant)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.model.zeta[-1] == pytest.approx(0.05, abs=1e-3)
    assert peak < 3e8


def test_a_negative_delay_is_said():
    found = fitted(2 * np.pi * np.geomspace(0.01, 1, 40), -0.4)
    assert found.model.zeta[-1] == pytest.approx(-0.4, abs=0.02)
    assert "negative" in found.outcome.advice


def test_common_divisors():
    assert common_divisor(np.array([0.6, 1.0, 1.4])) == pytest.approx(0.2)
    assert common_divisor(np.round(2 * np.pi * np.arange(3, 40) / 7, 6)) == pytest.approx(2 * np.pi / 7)
    assert common_divisor(np.geomspace(1, 100, 30)) is None
    assert common_divisor(np.array([0.0])) is None
    assert aliases(np.sqrt(np.arange(2.0, 9.0))) == ""
