"""A sine wave with a frequency of its own in the output of a periodic record, such as mains hum."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.between import NEIGHBOURS, strongest_line
from identification.signals import TimeRecord

LEVEL = 1e-3
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


def find_disturbance(record: TimeRecord, count: int) -> Disturbance | None:
    """The strongest line between the harmonics of the last `count` periods, fitted; None when none stands out.

        min over a, b, ω of ‖(I − M)(y − a cos ωt − b sin ωt)‖²,   M the mean over the periods

    by Gauss–Newton steps from the strongest line; what repeats with the period is the plant's [Kay1993, Section 7.10].
    """
    assert record.period is not None
    first = (record.period_count - count) * record.period
    length = count * record.period
    signal = _between(record.output[first : first + length], count)
    lines = np.fft.rfft(signal) / length
    free = np.arange(len(lines)) % count != 0
    free[-1] &= length % 2 == 1
    found = strongest_line(abs(lines[free]) ** 2)
    if found.p_value > LEVEL:
        return None
    k = np.flatnonzero(free)[np.argmax(abs(lines[free]))]
    time = _times(length, record) - (length - 1) / 2 * record.sample_time
    start = 2 * np.pi * k / (length * record.sample_time)
    omega, weights = _fitted(signal, time, float(start), count)
    tangents = _tangents(omega, weights, time, count)
    left = np.fft.rfft(signal - tangents[:2].T @ weights) / length
    around = [i for i in range(max(k - 2 * NEIGHBOURS, 1), min(k + 2 * NEIGHBOURS + 1, len(left))) if i % count]
    variance = length * float(np.mean(abs(left[around]) ** 2))
    covariance = variance * np.linalg.inv(tangents @ tangents.T)
    amplitude = float(np.hypot(*weights))
    slope = weights / amplitude
    middle = first * record.sample_time - time[0]
    return Disturbance(
        frequency=omega,
        amplitude=amplitude,
        phase=float(np.angle(np.exp(1j * (np.arctan2(-weights[1], weights[0]) - omega * middle)))),
        frequency_deviation=float(np.sqrt(covariance[2, 2])),
        amplitude_deviation=float(np.sqrt(slope @ covariance[:2, :2] @ slope)),
        p_value=found.p_value,
    )


def without(record: TimeRecord, disturbance: Disturbance) -> TimeRecord:
    """The record less the disturbance."""
    output = record.output - disturbance.signal(_times(len(record), record))
    return replace(record, output=np.asarray(output))


def _times(length: int, record: TimeRecord) -> FloatArray:
    return np.asarray(np.arange(length) * record.sample_time, dtype=np.float64)


def _between(signals: FloatArray, count: int) -> FloatArray:
    """Signals (…, L) less their mean over the periods."""
    periods = signals.reshape(*signals.shape[:-1], count, -1)
    return np.asarray(periods - periods.mean(axis=-2, keepdims=True)).reshape(signals.shape)


def _tangents(omega: float, weights: FloatArray, time: FloatArray, count: int) -> FloatArray:
    """Derivatives by a, b and ω, (3, L), without what repeats."""
    cosine, sine = np.cos(omega * time), np.sin(omega * time)
    by_frequency = time * (weights[1] * cosine - weights[0] * sine)
    return _between(np.stack([cosine, sine, by_frequency]), count)


def _fitted(signal: FloatArray, time: FloatArray, omega: float, count: int) -> tuple[float, FloatArray]:
    """ω and (a, b), steps kept within half a line."""
    widest = np.pi / (time[-1] - time[0])
    weights = _amplitudes(signal, omega, time, count)
    for _ in range(STEPS):
        tangents = _tangents(omega, weights, time, count)
        step = np.linalg.lstsq(tangents.T, signal - tangents[:2].T @ weights, rcond=None)[0]
        omega += float(np.clip(step[2], -widest, widest))
        weights = _amplitudes(signal, omega, time, count)
        if abs(step[2]) < SETTLED * widest:
            break
    return omega, weights


def _amplitudes(signal: FloatArray, omega: float, time: FloatArray, count: int) -> FloatArray:
    waves = _between(np.stack([np.cos(omega * time), np.sin(omega * time)]), count)
    return np.asarray(np.linalg.lstsq(waves.T, signal, rcond=None)[0])
