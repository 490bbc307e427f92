"""Inspection says what a measurement shows and what to change, and does not cry wolf."""

from dataclasses import replace

import numpy as np
import pytest

from identification.errors import MisuseError
from identification.measurements.inspection import find_period, inspect
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate

PLANT = RationalStructure(2, 1, 1, sample_time=0.1), np.array([-1.5, 0.7, 1.0, 0.5])


def good_record(noise: float = 0.1, seed: int = 0) -> TimeRecord:
    generator = np.random.default_rng(seed)
    spectrum = np.zeros(65, dtype=complex)
    spectrum[1:31] = 6 * np.exp(2j * np.pi * generator.uniform(size=30))
    u = np.tile(np.fft.irfft(spectrum), 8)
    y = simulate(*PLANT, u, periodic=True) + noise * generator.normal(size=len(u))
    return TimeRecord(u, y, 0.1, (0.0,), 128)


def test_a_good_record_has_no_warnings():
    for seed in range(20):
        record = good_record(seed=seed)
        seen = inspect(record)
        assert seen.warnings == ()
        assert (seen.samples, seen.periods, seen.period, seen.transient_periods) == (1024, 8, 128, 0)
        assert seen.duration == pytest.approx(102.4)
        assert seen.noise_deviation == pytest.approx(0.1, rel=0.12)
        clean = good_record(0.0, seed).output
        assert seen.signal_to_noise_db == pytest.approx(20 * np.log10(np.std(clean) / 0.1), abs=1)
        np.testing.assert_allclose(seen.excited_frequencies, 2 * np.pi * np.arange(1, 31) / 12.8)


def test_a_period_is_found_when_it_was_not_stated():
    seen = inspect(replace(good_record(), period=None))
    assert seen.period == 128
    assert seen.period_detected
    assert any("every 128 samples" in text for text in seen.warnings)
    noise = np.random.default_rng(0).normal(size=1000)
    assert find_period(noise) is None
    assert find_period(np.ones(100)) is None
    assert find_period(np.tile([1.0, 2.0, 1.0, 5.0], 9)[:33]) == 4
    assert inspect(TimeRecord(noise, noise, 1.0, (0.0,))).period is None


def test_without_periods_the_noise_is_unknown():
    generator = np.random.default_rng(1)
    u = generator.normal(size=800)
    seen = inspect(TimeRecord(u, simulate(*PLANT, u), 0.1, (0.0,)))
    assert seen.noise_deviation is None
    assert seen.signal_to_noise_db is None
    assert seen.warnings == ()


def test_one_fault_at_a_time_is_named():
    record = good_record()
    y = record.output
    drifting = inspect(replace(record, output=y + np.linspace(0, 20, len(y))))
    assert drifting.output_trend == pytest.approx(20, rel=0.1)
    assert any("drifts" in text for text in drifting.warnings)
    clipped = inspect(replace(record, output=np.clip(y, -2, 2)))
    assert clipped.saturated_fraction > 0.05
    assert any("saturates" in text for text in clipped.warnings)
    spiky = y.copy()
    spiky[[300, 700]] += 50
    assert inspect(replace(record, output=spiky)).outliers == 2
    assert inspect(replace(record, output=spiky, input=record.input + 1e-3 * y, period=None)).outliers == 2
    assert any("constant" in text for text in inspect(replace(record, input=np.ones(len(y)))).warnings)
    assert any("one period only" in text for text in inspect(replace(record, period=1000)).warnings)
    loud = inspect(good_record(noise=50.0))
    assert loud.signal_to_noise_db < 0
    assert any("stronger" in text for text in loud.warnings)
    shifted = inspect(replace(record, output=y + 7, input=record.input - 2))
    assert shifted.output_offset - y.mean() == pytest.approx(7)
    assert shifted.input_offset == pytest.approx(-2)


def test_a_transient_is_seen():
    record = good_record()
    generator = np.random.default_rng(3)
    y = simulate(*PLANT, record.input) + 0.01 * generator.normal(size=len(record))
    seen = inspect(replace(record, output=y))
    assert seen.transient_periods >= 1
    assert any("transient" in text for text in seen.warnings)


def test_zeros_are_refused():
    record = good_record()
    for channel in ("input", "output"):
        with pytest.raises(MisuseError, match=f"the {channel} is zero at every sample"):
            inspect(replace(record, **{channel: np.zeros(len(record))}))
    with pytest.raises(MisuseError, match="zero at every frequency"):
        inspect(FrequencyResponse([1.0, 2.0], [0, 0], (0.0,)))


def test_a_frequency_response():
    omega = np.geomspace(0.01, 1e4, 50)
    data = FrequencyResponse(omega, 1 / (1 + 1j * omega), (0.0,), None, (0.1 / (1 + omega**2) ** 0.5) ** 2)
    seen = inspect(data)
    assert (seen.count, seen.spacing, seen.variance_known, seen.warnings) == (50, "logarithmic", True, ())
    assert seen.relative_deviation == pytest.approx(0.1)
    assert (seen.lowest_frequency, seen.highest_frequency) == pytest.approx((0.01, 1e4))
    bare = inspect(FrequencyResponse(np.arange(1.0, 6.0), np.ones(5), (0.0,)))
    assert (bare.spacing, bare.variance_known, bare.relative_deviation) == ("linear", False, None)
    assert len(bare.warnings) == 2
    assert inspect(FrequencyResponse([1.0, 1.1, 5.0, 5.3], np.ones(4), (0.0,))).spacing in ("linear", "irregular")


def test_matrices_are_judged_by_their_norms():
    omega = np.linspace(0.1, 3.0, 30)
    response = np.zeros((30, 2, 2), dtype=complex)
    response[:, 0, 0], response[:, 1, 0] = 3.0, 4.0j
    seen = inspect(FrequencyResponse(omega, response, (0.0,), 1.0, np.full((30, 2, 2), 0.0625)))
    assert (seen.count, seen.spacing) == (30, "linear")
    assert seen.relative_deviation == pytest.approx(0.1)
    assert seen.warnings == ()
    with pytest.raises(MisuseError, match="zero at every frequency"):
        inspect(FrequencyResponse(omega, 0 * response, (0.0,), 1.0))
