"""Runge–Kutta of fourth order for several copies of a plant at once."""

from collections.abc import Callable

import numpy as np

from identification.arrays import FloatArray

State = list[FloatArray]
Slope = Callable[[State, FloatArray], State]

STEPS = 4


def integrate(
    slope: Slope, shown: Callable[[State], FloatArray], state: State, drive: FloatArray, step: float, samples: int
) -> FloatArray:
    """What is `shown` of the state at the samples, (M, samples), with STEPS steps of `step` seconds between two.

    `drive` (M, 2·STEPS·L) is one period of the input on the grid of half steps; it is played again and again.
    """
    grid, columns = drive.shape[1], np.ascontiguousarray(drive.T)
    recorded = np.empty((samples, drive.shape[0]))
    for n in range(samples * STEPS):
        if n % STEPS == 0:
            recorded[n // STEPS] = shown(state)
        now, middle, end = (columns[i % grid] for i in (2 * n, 2 * n + 1, 2 * n + 2))
        k1 = slope(state, now)
        k2 = slope(_ahead(state, k1, step / 2), middle)
        k3 = slope(_ahead(state, k2, step / 2), middle)
        k4 = slope(_ahead(state, k3, step), end)
        parts = zip(state, k1, k2, k3, k4, strict=True)
        state = [s + step / 6 * (a + 2 * (b + c) + d) for s, a, b, c, d in parts]
    return recorded.T


def _ahead(state: State, slopes: State, step: float) -> State:
    return [s + step * d for s, d in zip(state, slopes, strict=True)]


def refined(period: FloatArray) -> FloatArray:
    """One period of samples (M, L) on the grid of half steps (M, 2·STEPS·L), band-limited between the samples."""
    length = period.shape[1]
    spectra = np.fft.rfft(period)
    if length % 2 == 0:
        spectra[:, -1] /= 2
    return np.asarray(np.fft.irfft(2 * STEPS * spectra, n=2 * STEPS * length))
