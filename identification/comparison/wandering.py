"""Levels that do not stay: slow trends over a record, which are taken off, and random walks, which are noise."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.between import WANDERING, corner
from identification.comparison.noise import NoiseOfMean, noise_of_mean
from identification.signals import TimeRecord
from identification.spectral.periodic_average import PeriodicAverage, transient_periods

SETTLED = 12.0


@dataclass(frozen=True, eq=False)
class Trend:
    """A polynomial over a record, (samples,), and its degree."""

    signal: FloatArray
    degree: int


def slow_trend(record: TimeRecord, count: int) -> "Trend | None":
    """A polynomial over the last `count` = P periods without which the level no longer wanders; else None.

        min ‖(I − M)(y − Σ_k c_k L_k(t))‖²,   M the mean over the periods, L_k Legendre polynomials of degree 1 … 2P + 2

    None where the level stays as it is, and where it wanders however much is taken off: a random walk. The mean of the
    trend is not told from that of the plant; it is left in the record. (samples,) over the whole record.
    """
    assert record.period is not None
    length = count * record.period
    first = len(record.output) // record.period * record.period - length
    signal = record.output[first : first + length]
    if _corner(signal, count) > WANDERING:
        return None
    time = np.linspace(-1, 1, length)
    highest = 2 * count + 2
    columns = np.asarray(np.polynomial.legendre.legvander(time, highest)[:, 1:], dtype=np.float64)
    apart = _apart(columns.T, count).T
    for degree in range(1, highest + 1):
        weights = np.linalg.lstsq(apart[:, :degree], _apart(signal, count), rcond=None)[0]
        if _corner(signal - columns[:, :degree] @ weights, count, degree // 2 + 1) >= SETTLED:
            whole = 2 * (np.arange(len(record.output)) - first) / (length - 1) - 1
            return Trend(np.asarray(np.polynomial.legendre.legvander(whole, degree)[:, 1:] @ weights), degree)
    return None


def left_in_mean(period: int, degree: int, count: int, walks: bool) -> FloatArray:
    """What a trend of this degree over `count` periods, or a walk, may leave in the mean period, (n, period).

    The mean over the periods of polynomials; of a walk a sawtooth, which is the way from its start to its end.
    """
    highest = 1 if walks else degree
    time = np.linspace(-1, 1, count * period)
    columns = np.polynomial.legendre.legvander(time, highest)[:, 1:].T
    return np.asarray(columns.reshape(highest, count, period).mean(axis=1))


def wanders(record: TimeRecord, count: int) -> bool:
    """Whether the level of the last `count` periods is a random walk rather than noise around a mean."""
    assert record.period is not None
    length = count * record.period
    first = len(record.output) // record.period * record.period - length
    return _corner(record.output[first : first + length], count) <= WANDERING


def without_trend(record: TimeRecord, trend: FloatArray) -> TimeRecord:
    """The record less a trend of its output."""
    return replace(record, output=np.asarray(record.output - trend))


def steady_count(record: TimeRecord, walks: bool) -> int:
    """How many periods at the end of a record are steady; where it walks, judged by the differences of samples."""
    if not walks:
        return len(PeriodicAverage().steady_spectra(record)[1])
    assert record.period is not None
    count = record.period_count
    values = record.output[: count * record.period].reshape(count, -1)
    steps = np.fft.rfft(np.diff(values, axis=-1))
    return count - transient_periods(steps - steps.mean(axis=0))


def _corner(signal: FloatArray, count: int, lowest: int = 1) -> float:
    """`corner` of what lies between the harmonics from the line `lowest` on."""
    powers = abs(np.fft.rfft(signal - signal.mean())) ** 2
    lines = np.arange(len(powers))
    free = lines[(lines % count != 0) & (lines >= lowest)]
    return corner(np.asarray(powers[free], dtype=np.float64), free.astype(np.float64))


def _apart(signals: FloatArray, count: int) -> FloatArray:
    """Signals (…, L) less their mean over the periods."""
    periods = signals.reshape(*signals.shape[:-1], count, -1)
    return np.asarray(periods - periods.mean(axis=-2, keepdims=True)).reshape(signals.shape)


def wandering_noise(errors: ComplexArray, real: BoolArray) -> NoiseOfMean:
    """Noise of the mean spectrum where the errors E (P, K) are a random walk, with other noise on it.

        σ_k² = σ_D,k²/|1 − e^{−jω_k}|²,   D the spectra of the differences from sample to sample within each period

    The differences are stationary (`noise_of_mean`); that across the end of a period is left out, so that a sawtooth of
    any size, the walk over the whole record, may lie in the mean (`nuisance`), and its level says nothing (infinite
    variance at ω = 0) [BoxJenkins1976, Section 4.1].
    """
    period = 2 * errors.shape[1] - (2 if real[-1] else 1)
    values = np.fft.irfft(errors * period, n=period)
    steps = np.diff(values, axis=-1, prepend=values[:, :1])
    found = noise_of_mean(np.fft.rfft(steps) / period, real)
    omega = 2 * np.pi * np.arange(errors.shape[1]) / period
    gain = abs(1 - np.exp(-1j * omega)) ** 2
    variance = np.divide(found.variance, gain, out=np.full(len(gain), np.inf), where=gain > 0)
    return replace(found, variance=variance, ends=np.zeros_like(found.ends))
