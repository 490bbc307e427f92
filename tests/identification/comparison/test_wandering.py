"""Levels that wander or drift are no misfit: white residuals, no false effect, and it is said."""

from collections import Counter

import numpy as np
import pytest

from identification.comparison.compare import compare
from identification.comparison.gather import SLOW, WALKS, gather
from identification.comparison.wandering import slow_trend, wanders
from identification.signals import TimeRecord
from tests.support.oscillators import MODEL, PERIOD, SAMPLE_TIME, clean_records

LENGTH, COUNT = 256, 4
INPUT = np.tile(np.sin(2 * np.pi * 3 * np.arange(LENGTH) / LENGTH), COUNT)
TIME = np.arange(LENGTH * COUNT)


def record(noise):
    return TimeRecord(INPUT, noise, 0.5, (0.0,), LENGTH)


def walk(g, white=4.0):
    return record(np.cumsum(g.standard_normal(len(TIME))) + white * g.standard_normal(len(TIME)))


def swing(g, cycles, size=100.0):
    return record(size * np.sin(2 * np.pi * cycles * TIME / len(TIME) + 6 * g.random()) + g.standard_normal(len(TIME)))


def rms(records, lines=slice(1, None)):
    """Root mean square of the whitened mean spectra of records of nothing but noise, and what was noted."""
    found, notes = [], Counter()
    for batch in gather(records):
        z = batch.complex_residual(batch.whiten(batch.outputs).ravel())
        found.append(abs(z[:, lines]) ** 2)
        notes.update(text for _, text in batch.notes)
    return float(np.sqrt(np.mean(np.concatenate(found)))), notes


@pytest.mark.parametrize("white", [0.0, 4.0])
def test_a_random_walk_is_noise_whose_mean_is_not_compared(white):
    g = np.random.default_rng(1)
    records = [walk(g, white) for _ in range(60)]
    assert rms(records)[0] == pytest.approx(1.0, abs=0.05)
    low, notes = rms(records, slice(1, 4))
    assert 0.5 < low < 1.15
    assert notes[WALKS] + notes[SLOW] > 50
    said = [(batch, {m for m, text in batch.notes if text in (WALKS, SLOW)}) for batch in gather(records)]
    for batch, wandering in said:
        assert {int(m) for m in batch.members[np.isinf(batch.variances[:, 0])]} == wandering


@pytest.mark.parametrize("cycles", [0.3, 0.71, 1.1])
def test_a_swing_slower_than_the_record_leaves_no_misfit(cycles):
    g = np.random.default_rng(2)
    records = [swing(g, cycles) for _ in range(30)]
    found, notes = rms(records)
    assert found == pytest.approx(1.0, abs=0.06)
    assert rms(records, slice(1, 6))[0] < 1.4
    assert sum(notes.values()) >= 28


def test_a_drift_of_the_level_is_taken_off_where_it_is_and_nowhere_else():
    g = np.random.default_rng(3)
    ramp = record(0.02 * TIME + g.standard_normal(len(TIME)))
    trend = slow_trend(ramp, COUNT)
    assert trend is not None
    assert trend.degree == 1
    assert np.ptp(trend.signal) == pytest.approx(0.02 * len(TIME), rel=0.05)
    for _ in range(40):
        quiet = record(g.standard_normal(len(TIME)))
        assert slow_trend(quiet, COUNT) is None
        assert not wanders(quiet, COUNT)


def test_a_walking_sensor_on_a_right_model_fails_no_test():
    p = []
    for seed in range(30):
        g = np.random.default_rng(seed)
        records = []
        for r in clean_records(seed, sigma=3e-3):
            wandering = r.output + np.cumsum(2e-3 * g.standard_normal(len(r)))
            records.append(TimeRecord(r.input, wandering, SAMPLE_TIME, r.operating_point, PERIOD))
        found = compare(MODEL, gather(records))
        p.append(found.overall.p_value)
        assert found.notes
        assert {text for _, text in found.notes} <= {WALKS, SLOW}
    assert np.mean(np.array(p) < 0.05) < 0.2


def test_where_most_levels_walk_no_mean_value_is_compared():
    """A walk too small to be seen in one record would be called an offset there."""
    g = np.random.default_rng(4)
    lines = np.exp(2j * np.pi * g.random((4, 65)))
    lines[:, 0] = 0
    u = [np.tile(np.fft.irfft(one, n=128), 4) for one in lines]
    steps = [0.05, 0.05, 0.05, 0.00002]
    records = [
        TimeRecord(one, one + 0.01 * g.standard_normal(512) + s * np.cumsum(g.standard_normal(512)), 0.1, (p,), 128)
        for one, s, p in zip(u, steps, (0.0, 0.3, 0.6, 1.0), strict=True)
    ]
    every = gather(records)
    assert all(np.all(np.isinf(batch.variances[:, 0])) for batch in every)
    alone = gather(records[3:])[0]
    assert np.isfinite(alone.variances[0, 0])
