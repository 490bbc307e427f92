"""Records with varying scheduling: what is checked, what is found, what is dropped."""

import numpy as np
import pytest

from identification.errors import MisuseError, RangeError, ShapeError
from identification.scheduling import SchedulingVariable
from identification.varying.records import Periodicity, VaryingRecord, periodicity, scheduling_period, steady_periods

SPEED = SchedulingVariable("speed", "m/s", -1.0, 1.0)


def periodic(length: int, samples: int, seed: int = 0) -> np.ndarray:
    wave = np.random.default_rng(seed).standard_normal(length)
    return np.tile(wave, samples // length + 1)[:samples]


def record(u: np.ndarray, p: np.ndarray, period: int | None = None, **options: object) -> VaryingRecord:
    return VaryingRecord(u, np.zeros_like(u), p, 0.1, period, **options)  # type: ignore[arg-type]


def test_vectors_are_channels_and_sizes_must_fit() -> None:
    assert record(np.ones(10), np.ones(10)).scheduling.shape == (10, 1)
    with pytest.raises(ShapeError, match="9 samples"):
        record(np.ones(10), np.ones(9))
    with pytest.raises(RangeError, match="not a finite number"):
        record(np.ones(10), np.full(10, np.nan))
    with pytest.raises(RangeError, match="sample time"):
        VaryingRecord(np.ones(10), np.ones(10), np.ones(10), 0.0)


def test_scheduling_outside_its_declared_range_is_refused() -> None:
    p = np.linspace(-1, 1, 10)
    assert len(record(np.ones(10), p, variables=(SPEED,))) == 10
    with pytest.raises(RangeError, match=r"speed runs from -1\.1 to 1\.1 m/s"):
        record(np.ones(10), 1.1 * p, variables=(SPEED,))


@pytest.mark.parametrize("stated", [None, 60, 120])
def test_periods_are_found(stated: int | None) -> None:
    found = periodicity(record(periodic(60, 600), periodic(12, 600, 1), stated))
    assert found == Periodicity(stated or 60, 12, 0.0)


def test_a_common_period_is_found_when_neither_divides_the_other() -> None:
    assert periodicity(record(periodic(20, 600), periodic(12, 600, 1))).period == 60


def test_unsynchronised_scheduling_is_refused_with_how_far_off_it_is() -> None:
    u, p = periodic(60, 600), periodic(13, 600, 1)
    with pytest.raises(MisuseError, match=r"after 60 and 13 samples, so together only after 780.*4\.61538"):
        periodicity(record(u, p))
    with pytest.raises(MisuseError, match=r"the period is 4\.61538 of these, not a whole number") as caught:
        periodicity(record(u, p, 60))
    assert caught.value.field == "scheduling"


def test_noisy_scheduling_passes_within_the_tolerance_only() -> None:
    p = periodic(12, 600, 1) + 1e-4 * np.random.default_rng(2).standard_normal(600)
    with pytest.raises(MisuseError, match=r"1e-06 is allowed"):
        periodicity(record(periodic(60, 600), p, 60))
    assert periodicity(record(periodic(60, 600), p, 60), tolerance=1e-2).scheduling_period == 12


def test_signals_without_period_and_too_few_periods_are_refused() -> None:
    noise = np.random.default_rng(3).standard_normal(600)
    with pytest.raises(MisuseError, match="input does not repeat"):
        periodicity(record(noise, periodic(12, 600)))
    with pytest.raises(MisuseError, match=r"1\.5 periods of 400"):
        periodicity(record(periodic(400, 600), periodic(10, 600), 400))
    with pytest.raises(MisuseError, match="scheduling does not repeat"):
        scheduling_period(record(noise, noise))
    assert scheduling_period(record(noise, periodic(12, 600))) == 12


def test_transient_periods_are_dropped_by_a_rule_that_is_reported() -> None:
    generator = np.random.default_rng(4)
    y = periodic(60, 615, 5) + 0.1 * generator.standard_normal(615)
    y[:90] += 3 * np.exp(-np.arange(90) / 30)
    steady = steady_periods(VaryingRecord(periodic(60, 615), y, periodic(12, 615, 1), 1.0))
    assert (steady.dropped, steady.left_over, steady.output.shape) == (2, 15, (8, 60, 1))
    assert "99.9 % quantile" in steady.rule
    asked = steady_periods(VaryingRecord(periodic(60, 615), y, periodic(12, 615, 1), 1.0), drop_periods=5)
    assert (asked.dropped, asked.rule) == (5, "as many as asked for")
    with pytest.raises(MisuseError, match="9 are dropped"):
        steady_periods(VaryingRecord(periodic(60, 615), y, periodic(12, 615, 1), 1.0), drop_periods=9)
