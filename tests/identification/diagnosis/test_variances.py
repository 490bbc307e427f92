"""What varies from record to record, drifts within one, or is rounded: named as such, and nothing else for it."""

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.diagnosis.record_by_record import record_by_record
from identification.diagnosis.variances import variations
from identification.effects.library import library, variance_library
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.signals import TimeRecord
from tests.support.oscillators import (
    MODEL,
    OMEGA,
    PERIOD,
    POINTS,
    SAMPLE_TIME,
    batches,
    linear,
    phasors,
    played,
    records,
)

TWICE = tuple(p for p in POINTS for _ in range(2))


def made(seed, stiffness, sigma=2e-3, extra=None):
    """Two records at every point, the stiffness of each off by what is given (as a part of it)."""
    g = np.random.default_rng(seed)
    inputs = [phasors(g) for _ in TWICE]
    off = [s * (30 + 10 * p) / 10 for s, p in zip(stiffness(g), TWICE, strict=True)]
    outputs = [(a, linear(p + o, a, extra)) for p, o, a in zip(TWICE, off, inputs, strict=True)]
    return gather(records(outputs, g, sigma, points=TWICE))


def random_stiffness(size):
    return lambda g: size * g.standard_normal(len(TWICE))


def nothing(g):
    return np.zeros(len(TWICE))


def test_a_stiffness_that_is_another_in_every_record_is_no_misplaced_point():
    for seed in range(4):
        found = diagnose(MODEL, made(seed, random_stiffness(0.02)), seed=seed)
        assert found.variation is not None
        assert found.variation.effect.kind == "record_variation"
        assert found.variation.effect.coefficient == 1
        assert 0.01 < found.variation.size < 0.04
        assert (found.verdict, found.announced) == ("explained", ())
        assert "log with every experiment" in found.reason


@pytest.mark.parametrize("seed", range(4))
def test_a_stiffness_that_varies_too_much_for_a_first_order_is_neither(seed):
    found = diagnose(MODEL, made(seed, random_stiffness(0.12), sigma=1e-3), seed=seed)
    assert (found.verdict, found.announced) == ("explained", ())
    assert (found.variation.effect.kind, found.variation.effect.coefficient) == ("record_variation", 1)
    assert 0.05 < found.variation.size < 0.25


def test_each_record_alone_gives_the_scatter_of_its_own_stiffness():
    g = np.random.default_rng(8)
    off = 0.1 * g.standard_normal(len(TWICE))
    records_alone = record_by_record(fit(MODEL, Rows(made(8, lambda _: off, sigma=1e-3)), iterations=40))
    stiffness = np.array([(30 + 10 * p) * (1 + o) for p, o in zip(TWICE, off, strict=True)])
    assert np.std(records_alone.coefficients[:, 1] / stiffness) < 2e-3 * np.mean(
        records_alone.coefficients[:, 1] / stiffness
    )
    sizes = [records_alone.scattered(i) for i in range(records_alone.coefficients.shape[1])]
    assert np.argmin([cost + spread for _, cost, spread in sizes]) == 1
    assert sizes[1][0] == pytest.approx(np.std(off), rel=0.5)


def test_three_points_cannot_tell_a_misplaced_one_from_a_bend_and_the_bend_comes_first():
    three = (POINTS[0], POINTS[len(POINTS) // 2], POINTS[-1])
    g = np.random.default_rng(9)
    outputs = [(a, linear(p + 0.4 * (p == three[1]), a)) for p, a in ((p, phasors(g)) for p in three)]
    found = diagnose(MODEL, gather(records(outputs, g, 1e-3, points=three)))
    kinds = [one.score.candidate.effect.kind for one in found.announced]
    assert "misplaced_point" in kinds
    assert kinds[0] != "misplaced_point"
    assert not found.confident


def test_a_misplaced_point_and_a_delay_are_no_variation_from_record_to_record():
    def misplaced(g):
        return np.where(np.array(TWICE) == 0.5, 0.05, 0.0)

    found = diagnose(MODEL, made(5, misplaced))
    assert found.variation is None
    assert found.best.score.candidate.effect.kind == "misplaced_point"
    late = diagnose(MODEL, made(6, nothing, extra=lambda w: np.exp(-0.02j * w)))
    assert late.variation is None
    assert late.best.score.candidate.effect.kind == "delay"


def test_their_tests_keep_their_size_where_nothing_varies():
    small = {one.kind: [] for one in variance_library()}
    for seed in range(60):
        base = fit(MODEL, Rows(made(seed, nothing)))
        for one in variations(base, np.random.default_rng(seed)):
            small[one.effect.kind].append(one.p_value)
    for kind, p in small.items():
        assert len(p) == 60, kind
        assert np.mean(np.array(p) < 0.05) <= 0.15, kind


def drifting(seed, slope, periods=6):
    """The stiffness grows by `slope` (as a part of it) a period, filtered sample by sample, held input."""
    g = np.random.default_rng(seed)
    found = []
    for p in POINTS:
        u = np.tile(played(phasors(g), np.arange(PERIOD) * SAMPLE_TIME), periods + 2)
        sign = g.choice([-1.0, 1.0])
        y, state = np.zeros(len(u)), np.zeros(2)
        for k in range(periods + 2):
            stiffness = (30 + 10 * p) * (1 + sign * slope * (k - 2 - (periods - 1) / 2))
            b, a, _ = cont2discrete(([1.0], [1.0, 1.5, stiffness]), SAMPLE_TIME)
            part = slice(k * PERIOD, (k + 1) * PERIOD)
            y[part], state = lfilter(b.ravel(), a, u[part], zi=state)
        kept = slice(2 * PERIOD, None)
        noisy = y[kept] + 2e-3 * g.standard_normal(periods * PERIOD)
        found.append(TimeRecord(u[kept], noisy, SAMPLE_TIME, (p,), PERIOD, hold="zero"))
    return gather(found)


def test_a_drift_within_the_records_is_seen_in_the_periods():
    found = diagnose(MODEL, drifting(1, 0.01))
    (one,) = found.variations
    assert (one.effect.kind, one.effect.coefficient) == ("drifting_parameter", 1)
    assert one.size == pytest.approx(0.01, rel=0.4)
    assert found.announced == ()
    assert diagnose(MODEL, drifting(2, 0.0)).variations == ()


def test_rounding_that_later_filtering_hides_is_named():
    """A converter whose values were smoothed afterwards: no grid is left, and the error repeats with the period."""
    g = np.random.default_rng(7)
    found = []
    for p in POINTS:
        a = phasors(g)
        y = linear(p, a)
        white = np.tile(0.05 * (g.random(PERIOD) - 0.5), 4)
        noisy = np.tile(y, 4) + white + 5e-4 * g.standard_normal(4 * PERIOD)
        found.append(
            TimeRecord(np.tile(played(a, np.arange(PERIOD) * SAMPLE_TIME), 4), noisy, SAMPLE_TIME, (p,), PERIOD)
        )
    one = diagnose(MODEL, gather(found)).variation
    assert one.effect.kind == "quantisation"
    assert one.size == pytest.approx(0.05, rel=0.1)


def test_they_are_no_effects_on_the_mean():
    kinds = {one.kind for one in variance_library()}
    assert kinds == {"quantisation", "record_variation", "drifting_parameter", "jitter"}
    assert not kinds & {one.kind for one in library()}
    assert len(OMEGA) > 5


@pytest.mark.parametrize("periods", [2, 3])
def test_few_periods_say_nothing_of_jitter_and_break_nothing(periods):
    """Two periods leave nothing once a straight line over them is taken off."""
    found = diagnose(MODEL, batches(3, 0.02, periods=periods))
    assert found.variations == ()
    kinds = {one.effect.kind for one in variations(found.base, np.random.default_rng(0))}
    assert ("jitter" in kinds) == (periods > 2)
