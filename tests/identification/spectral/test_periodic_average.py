"""Averaging over periods: exact without noise, calibrated with it, honest about transients and about ω = 0."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from identification.channels import UNSTATED
from identification.errors import MisuseError, RangeError
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate
from identification.spectral.periodic_average import PeriodicAverage

PLANT = RationalStructure(2, 1, 1, sample_time=0.1), np.array([-1.5, 0.7, 1.0, 0.5])
NOISE = RationalStructure(0, 0, n_c=1, n_d=1, sample_time=0.1), np.array([0.0, 0.3, -0.6])
PERIOD = 64
AT_ZERO = UNSTATED.at_level(0.0)


def record(
    generator: np.random.Generator,
    periods: int,
    noise: float,
    input_noise: float = 0.0,
    steady: bool = True,
    period: int = PERIOD,
) -> TimeRecord:
    u = np.tile(generator.normal(size=period), periods)
    y = simulate(*PLANT, u, periodic=steady)
    y = y + simulate(*NOISE, u, noise * generator.normal(size=len(u)))
    return TimeRecord(u + input_noise * generator.normal(size=len(u)), y, 0.1, (2.0,), period, AT_ZERO)


def true(data: FrequencyResponse) -> np.ndarray:
    return PLANT[0].plant_response(PLANT[1], data.frequencies)


def test_a_steady_noise_free_record_gives_the_response_exactly():
    data = PeriodicAverage().estimate(record(np.random.default_rng(0), 3, 0.0))
    assert len(data) == PERIOD // 2 + 1
    assert data.operating_point == (2.0,)
    assert data.sample_time == 0.1
    np.testing.assert_allclose(data.response, true(data), rtol=1e-10)
    assert np.all(data.variance > 0)
    assert np.all(data.variance < 1e-20 * abs(data.response).max() ** 2)


@pytest.mark.parametrize("input_noise", [0.0, 0.1])
def test_the_variance_is_calibrated(input_noise):
    """E|Ĝ − G|²/σ̂² = d/(d − 1) where noise is circular, and half of (d/(d − 2)) at real lines."""
    generator = np.random.default_rng(1)
    periods, runs = 12, 150
    average = PeriodicAverage(drop_periods=0, threshold=0.2)
    inner, ends = [], []
    for _ in range(runs):
        data = average.estimate(record(generator, periods, 0.2, input_noise, period=256))
        ratio = abs(data.response - true(data)) ** 2 / data.variance
        real = np.isin(data.frequencies, [0.0, np.pi / 0.1])
        inner.extend(ratio[~real])
        ends.extend(ratio[real])
    assert data.variance_degrees_of_freedom == periods - 1
    assert np.mean(inner) == pytest.approx(11 / 10, rel=0.05)
    assert np.mean(np.array(inner) > stats.f.ppf(0.95, 2, 22)) == pytest.approx(0.05, abs=0.01)
    assert np.mean(2 * np.array(ends) > stats.f.ppf(0.95, 1, 11)) == pytest.approx(0.05, abs=0.035)


def test_correlated_noise_on_input_and_output_cancels_in_the_variance():
    """What goes through the plant is no noise: disturbing u, and y by G times it, leaves only rounding."""
    generator = np.random.default_rng(2)
    lines = generator.normal(size=(4, 33)) + 1j * generator.normal(size=(4, 33))
    lines[:, [0, -1]] = lines[:, [0, -1]].real
    lines = 10 + lines
    response = PLANT[0].plant_response(PLANT[1], 2 * np.pi * np.arange(33) / 6.4)
    u, y = (np.fft.irfft(x, axis=1).ravel() for x in (lines, response * lines))
    data = PeriodicAverage(drop_periods=0).estimate(TimeRecord(u, y, 0.1, (0.0,), PERIOD, AT_ZERO))
    assert np.all(data.variance < 1e-20)
    np.testing.assert_allclose(data.response, response, rtol=1e-9)


def test_only_excited_lines_are_given():
    generator = np.random.default_rng(3)
    spectrum = np.zeros(33, dtype=complex)
    spectrum[[3, 7, 20]] = 5 * np.exp(2j * np.pi * generator.uniform(size=3))
    u = np.tile(np.fft.irfft(spectrum), 6)
    y = simulate(*PLANT, u, 0.01 * generator.normal(size=len(u)), periodic=True)
    measured = TimeRecord(u + 1e-4 * generator.normal(size=len(u)), y, 0.1, (0.0,), PERIOD)
    data = PeriodicAverage().estimate(measured)
    np.testing.assert_allclose(data.frequencies, 2 * np.pi * np.array([3, 7, 20]) / 6.4)


def test_a_single_line_at_zero():
    y = 3.0 + 0.1 * np.random.default_rng(0).normal(size=80)
    data = PeriodicAverage(drop_periods=0).estimate(TimeRecord(np.full(80, 2.0), y, 0.1, (0.0,), 8, AT_ZERO))
    assert data.frequencies == pytest.approx([0.0])
    means = y.reshape(10, 8).mean(axis=1)
    assert data.response == pytest.approx([means.mean() / 2])
    assert data.variance == pytest.approx([2 * np.var(means, ddof=1) / 10 / 4])
    with pytest.raises(MisuseError, match="no line"):
        PeriodicAverage(real_lines=False).estimate(TimeRecord(np.full(80, 2.0), y, 0.1, (0.0,), 8, AT_ZERO))


def test_transients_are_dropped_and_steady_periods_kept():
    generator = np.random.default_rng(4)
    automatic, runs = PeriodicAverage(), 60
    kept = [len(automatic.steady_spectra(record(generator, 8, 0.1))[0]) for _ in range(runs)]
    assert kept.count(8) >= 57
    cut = [len(automatic.steady_spectra(record(generator, 8, 0.01, steady=False))[0]) for _ in range(runs)]
    assert cut.count(7) >= 50
    assert min(cut) >= 4


def test_what_cannot_be_averaged_is_refused():
    one = record(np.random.default_rng(5), 3, 0.1)
    with pytest.raises(MisuseError, match="at least two must remain"):
        PeriodicAverage(drop_periods=2).estimate(one)
    with pytest.raises(MisuseError, match="fewer than two whole periods"):
        PeriodicAverage().estimate(replace(one, period=100))
    with pytest.raises(MisuseError, match="no period"):
        PeriodicAverage().estimate(replace(one, period=None))
    with pytest.raises(MisuseError, match="no line"):
        PeriodicAverage().estimate(replace(one, input=np.zeros(len(one))))
    for wrong in ({"drop_periods": -1}, {"threshold": 1.0}):
        with pytest.raises(RangeError):
            PeriodicAverage(**wrong)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), c=st.sampled_from([-1e-6, 0.5, 1e9]), d=st.sampled_from([-1e3, 1e-9]))
def test_units_of_the_signals(seed, c, d):
    one = record(np.random.default_rng(seed), 5, 0.1, 0.01)
    scaled = replace(one, input=c * one.input, output=d * one.output, sample_time=1e-6)
    a, b = PeriodicAverage().estimate(one), PeriodicAverage().estimate(scaled)
    np.testing.assert_allclose(b.response, d / c * a.response, rtol=1e-9)
    np.testing.assert_allclose(b.variance, (d / c) ** 2 * a.variance, rtol=1e-6)
    np.testing.assert_allclose(b.frequencies, 1e5 * a.frequencies, rtol=1e-12)
