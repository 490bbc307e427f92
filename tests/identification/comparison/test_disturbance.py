"""Hum whose frequency lies between the lines: found, fitted without bias, and taken away."""

import numpy as np
import pytest

from identification.comparison.disturbance import find_disturbance, without
from identification.signals import TimeRecord

PERIOD, PERIODS, STEP = 200, 5, 0.01
TIME = np.arange(PERIOD * PERIODS) * STEP
OMEGA, AMPLITUDE, PHASE, NOISE = 2 * np.pi * 7.83, 0.3, 0.9, 0.2


def record(seed, amplitude=AMPLITUDE, omega=OMEGA, dropped=0, noise=NOISE):
    generator = np.random.default_rng(seed)
    repeating = np.tile(np.cumsum(generator.standard_normal(PERIOD)), PERIODS + dropped)
    time = np.arange(len(repeating)) * STEP
    y = repeating + amplitude * np.cos(omega * time + PHASE) + noise * generator.standard_normal(len(time))
    return TimeRecord(repeating, y, STEP, (0.0,), PERIOD)


def test_frequency_and_amplitude_lie_within_their_deviations():
    z = []
    for seed in range(80):
        found = find_disturbance(record(seed), PERIODS)
        assert found is not None
        z.append(
            (
                (found.frequency - OMEGA) / found.frequency_deviation,
                (found.amplitude - AMPLITUDE) / found.amplitude_deviation,
            )
        )
    z = np.array(z)
    assert np.all(abs(z.mean(axis=0)) < 4 / np.sqrt(80))
    assert np.all((z.std(axis=0) > 0.75) & (z.std(axis=0) < 1.3))


def test_the_phase_is_that_at_the_first_sample_also_when_periods_were_dropped():
    one = record(1, dropped=2, noise=0.01)
    found = find_disturbance(one, PERIODS)
    assert found is not None
    assert found.phase == pytest.approx(PHASE, abs=0.02)


def test_what_is_left_is_the_noise_and_what_repeats_stays():
    one = record(2)
    found = find_disturbance(one, PERIODS)
    assert found is not None
    clean = without(one, found)
    true = one.output - AMPLITUDE * np.cos(OMEGA * TIME + PHASE)
    assert np.std(clean.output - true) < 0.1 * AMPLITUDE
    assert find_disturbance(clean, PERIODS) is None


def test_noise_alone_has_no_disturbance():
    found = [find_disturbance(record(seed, amplitude=0.0), PERIODS) for seed in range(100)]
    assert sum(one is not None for one in found) <= 2


def test_what_lies_on_a_line_of_the_period_is_the_plants():
    assert find_disturbance(record(3, omega=2 * np.pi * 8.0), PERIODS) is None
