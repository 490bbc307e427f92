"""Sine waves with frequencies of their own in the output of a periodic record, such as mains hum."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.between import NEIGHBOURS, flattened, standing_out, strongest_line
from identification.outcome import TestResult
from identification.signals import TimeRecord

LEVEL, MOST = 1e-3, 6
STEPS, SETTLED = 30, 1e-10


@dataclass(frozen=True)
class Disturbance:
    """A cos(ωt + φ) in the output, t = 0 at the first sample; ω = `frequency` rad/s, A = `amplitude`, φ = `phase` rad.

    With the standard deviations of ω and A where the other noise is flat around ω, and p of the test that found it.
    """

    frequency: float
    amplitude: float
    phase: float
    frequency_deviation: float
    amplitude_deviation: float
    p_value: float

    def signal(self, time: FloatArray) -> FloatArray:
        """A cos(ωt + φ) at the times in seconds."""
        return np.asarray(self.amplitude * np.cos(self.frequency * time + self.phase))


def find_disturbances(record: TimeRecord, count: int, most: int = MOST) -> tuple[Disturbance, ...]:
    """The lines that stand out between the harmonics of the last `count` periods, strongest first, fitted together.

        min over a, b, ω of ‖(I − M)(y − Σ_i a_i cos ω_i t − b_i sin ω_i t)‖²,   M the mean over the periods

    by Gauss–Newton steps from the strongest line, then from the strongest of what that leaves, `most` of them; what
    repeats with the period is the plant's [Kay1993, Section 7.10].
    """
    assert record.period is not None
    first = (record.period_count - count) * record.period
    length = count * record.period
    signal = _between(record.output[first : first + length], count)
    time = _times(length, record) - (length - 1) / 2 * record.sample_time
    omega: FloatArray = np.zeros(0)
    p_values: list[float] = []
    left = signal
    while len(omega) < most:
        line = 2 * np.pi / (length * record.sample_time)
        k, found = _strongest(left, count, omega / line)
        if found.p_value > LEVEL:
            break
        p_values.append(found.p_value)
        omega, weights = _fitted(signal, time, np.append(omega, k * line), count)
        left = signal - weights @ _waves(omega, time, count)
    if not p_values:
        return ()
    covariance = _covariance(left, omega, weights, time, count)
    middle = first * record.sample_time - time[0]
    every = zip(omega, weights.reshape(2, -1).T, covariance, p_values, strict=True)
    return tuple(_disturbance(*one, middle) for one in every)


def _strongest(signal: FloatArray, count: int, known: FloatArray) -> tuple[int, TestResult]:
    """The line k of the whole record that stands out most between the harmonics, and the test of it.

    Lines next to `known` ones, whose size or frequency may not be quite constant, are not looked at.
    """
    length = len(signal)
    powers = abs(np.fft.rfft(signal) / length) ** 2
    free = np.arange(len(powers)) % count != 0
    free[-1] &= length % 2 == 1
    for k in known:
        free &= abs(np.arange(len(powers)) - k) > 1.5
    lines = np.flatnonzero(free)
    flat = flattened(powers[free], lines.astype(np.float64), length)
    return int(lines[np.argmax(standing_out(flat))]), strongest_line(flat)


def _disturbance(
    omega: float, weights: FloatArray, covariance: FloatArray, p_value: float, middle: float
) -> Disturbance:
    """From weights (a, b) of cosine and sine about the middle of the record, with the covariance of (a, b, ω)."""
    amplitude = float(np.hypot(*weights))
    slope = weights / amplitude
    return Disturbance(
        frequency=float(omega),
        amplitude=amplitude,
        phase=float(np.angle(np.exp(1j * (np.arctan2(-weights[1], weights[0]) - omega * middle)))),
        frequency_deviation=float(np.sqrt(covariance[2, 2])),
        amplitude_deviation=float(np.sqrt(slope @ covariance[:2, :2] @ slope)),
        p_value=p_value,
    )


def _covariance(left: FloatArray, omega: FloatArray, weights: FloatArray, time: FloatArray, count: int) -> FloatArray:
    """Of (a_i, b_i, ω_i), (n, 3, 3), with the noise around each line in what is left."""
    tangents = _tangents(omega, weights, time, count)
    inverse = np.linalg.pinv(tangents @ tangents.T, rcond=1e-15, hermitian=True)
    length, n = len(time), len(omega)
    powers = abs(np.fft.rfft(left) / length) ** 2
    found = []
    for i, k in enumerate(np.round(omega * length * (time[1] - time[0]) / (2 * np.pi)).astype(int)):
        around = [j for j in range(max(k - 2 * NEIGHBOURS, 1), min(k + 2 * NEIGHBOURS + 1, len(powers))) if j % count]
        own = [i, n + i, 2 * n + i]
        found.append(length * float(np.mean(powers[around])) * inverse[np.ix_(own, own)])
    return np.array(found)


def without(record: TimeRecord, disturbances: Sequence[Disturbance]) -> TimeRecord:
    """The record less the disturbances."""
    time = _times(len(record), record)
    output = record.output - sum((one.signal(time) for one in disturbances), np.zeros(len(record)))
    return replace(record, output=np.asarray(output))


def _times(length: int, record: TimeRecord) -> FloatArray:
    return np.asarray(np.arange(length) * record.sample_time, dtype=np.float64)


def _between(signals: FloatArray, count: int) -> FloatArray:
    """Signals (…, L) less their mean over the periods."""
    periods = signals.reshape(*signals.shape[:-1], count, -1)
    return np.asarray(periods - periods.mean(axis=-2, keepdims=True)).reshape(signals.shape)


def _waves(omega: FloatArray, time: FloatArray, count: int) -> FloatArray:
    """Cosines, then sines, of frequencies (n,) without what repeats, (2n, L)."""
    angle = omega[:, None] * time
    return _between(np.concatenate([np.cos(angle), np.sin(angle)]), count)


def _tangents(omega: FloatArray, weights: FloatArray, time: FloatArray, count: int) -> FloatArray:
    """Derivatives by a_i, then b_i, then ω_i, (3n, L), without what repeats."""
    angle = omega[:, None] * time
    cosine, sine = np.cos(angle), np.sin(angle)
    a, b = weights.reshape(2, -1, 1)
    return _between(np.concatenate([cosine, sine, time * (b * cosine - a * sine)]), count)


def _fitted(signal: FloatArray, time: FloatArray, omega: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """ω (n,) and the weights (2n,), steps kept within half a line."""
    widest = np.pi / (time[-1] - time[0])
    weights = _amplitudes(signal, omega, time, count)
    for _ in range(STEPS):
        tangents = _tangents(omega, weights, time, count)
        left = signal - tangents[: len(weights)].T @ weights
        step = np.linalg.lstsq(tangents.T, left, rcond=None)[0][len(weights) :]
        omega = omega + np.clip(step, -widest, widest)
        weights = _amplitudes(signal, omega, time, count)
        if np.max(abs(step)) < SETTLED * widest:
            break
    return omega, weights


def _amplitudes(signal: FloatArray, omega: FloatArray, time: FloatArray, count: int) -> FloatArray:
    return np.asarray(np.linalg.lstsq(_waves(omega, time, count).T, signal, rcond=None)[0])
