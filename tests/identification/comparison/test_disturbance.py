"""Hum whose frequency lies between the lines: found, fitted without bias, and taken away."""

import numpy as np
import pytest

from identification.comparison.disturbance import find_disturbances, without
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
    z, false = [], 0
    for seed in range(80):
        found, *more = find_disturbances(record(seed), PERIODS)
        false += len(more)
        z.append(
            (
                (found.frequency - OMEGA) / found.frequency_deviation,
                (found.amplitude - AMPLITUDE) / found.amplitude_deviation,
            )
        )
    assert false <= 2
    z = np.array(z)
    assert np.all(abs(z.mean(axis=0)) < 4 / np.sqrt(80))
    assert np.all((z.std(axis=0) > 0.75) & (z.std(axis=0) < 1.3))


def test_the_phase_is_that_at_the_first_sample_also_when_periods_were_dropped():
    one = record(1, dropped=2, noise=0.01)
    (found,) = find_disturbances(one, PERIODS)
    assert found.phase == pytest.approx(PHASE, abs=0.02)


def test_what_is_left_is_the_noise_and_what_repeats_stays():
    one = record(2)
    found = find_disturbances(one, PERIODS)
    clean = without(one, found)
    true = one.output - AMPLITUDE * np.cos(OMEGA * TIME + PHASE)
    assert np.std(clean.output - true) < 0.1 * AMPLITUDE
    assert find_disturbances(clean, PERIODS) == ()


def test_noise_alone_has_no_disturbance():
    found = [find_disturbances(record(seed, amplitude=0.0), PERIODS) for seed in range(100)]
    assert sum(len(one) for one in found) <= 2


def test_what_lies_on_a_line_of_the_period_is_the_plants():
    assert find_disturbances(record(3, omega=2 * np.pi * 8.0), PERIODS) == ()


def test_mains_with_its_harmonics_is_taken_away_even_a_hundred_times_above_the_noise():
    one = record(4, amplitude=2.0, noise=0.01)
    more = sum(a * np.cos(f * OMEGA * TIME + f) for a, f in ((1.5, 2), (1.0, 5)))
    found = find_disturbances(TimeRecord(one.input, one.output + more, STEP, (0.0,), PERIOD), PERIODS)
    assert sorted(round(each.frequency / OMEGA, 3) for each in found) == [1.0, 2.0, 5.0]
    clean = without(TimeRecord(one.input, one.output + more, STEP, (0.0,), PERIOD), found)
    true = one.output - 2.0 * np.cos(OMEGA * TIME + PHASE)
    assert np.std(clean.output - true) < 0.2 * 0.01


def test_a_level_that_wanders_is_no_line():
    found = []
    for seed in range(60):
        g = np.random.default_rng(seed)
        wandering = np.cumsum(g.standard_normal(len(TIME)))
        found.append(find_disturbances(TimeRecord(TIME, wandering, STEP, (0.0,), PERIOD), PERIODS))
    assert sum(len(one) > 0 for one in found) <= 2
