"""The spectrum of the output noise of a record, for a summary."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from identification.arrays import FloatArray
from identification.varying.harmonic_noise import harmonic_noise
from identification.varying.records import SteadyPeriods

MOST_LINES = 200


@dataclass(frozen=True, eq=False)
class NoiseSpectrum:
    """`spectrum` (F, n_y) at ω (F,) rad/s, such that white noise has its variance at every ω; `covariance` (n_y, n_y).

    `degrees_of_freedom`: of each value.
    """

    frequencies: FloatArray
    spectrum: FloatArray
    covariance: FloatArray
    degrees_of_freedom: float


def noise_between_harmonics(steady: SteadyPeriods, sample_time: float) -> NoiseSpectrum:
    """From the lines between the harmonics of a synchronised record [Goos2014, Section 3.2]; raises MisuseError."""
    found = harmonic_noise(steady)
    periods, period, _ = steady.output.shape
    covariance = found.covariance * periods / period
    lines = _some(period // 2 + 1)
    return NoiseSpectrum(
        2 * np.pi * lines / (period * sample_time),
        np.einsum("fyy->fy", covariance[lines].real),
        covariance.mean(axis=0).real,
        2.0 * found.degrees_of_freedom,
    )


def noise_of_errors(errors: FloatArray, sample_time: float) -> NoiseSpectrum:
    """From what a model leaves of the output, (N, n_y): the periodogram, averaged over bands of equal width."""
    count = len(errors)
    rest = errors - errors.mean(axis=0)
    power = abs(np.fft.rfft(rest, axis=0)[1:]) ** 2 / count
    bands = max(1, min(MOST_LINES, len(power) // 20))
    edges = np.linspace(0, len(power), bands + 1).astype(int)
    spectrum = np.array([power[low:high].mean(axis=0) for low, high in pairwise(edges)])
    middle = 1 + (edges[:-1] + edges[1:] - 1) / 2
    omega = 2 * np.pi * middle / (count * sample_time)
    return NoiseSpectrum(omega, spectrum, rest.T @ rest / count, 2.0 * len(power) / bands)


def _some(count: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return np.unique(np.linspace(0, count - 1, min(count, MOST_LINES)).astype(np.int64))
