"""Fourth-order Runge-Kutta over many experiments at once, and inputs on its half steps."""

from collections.abc import Callable

import numpy as np

from identification.arrays import FloatArray

STEPS = 12
Slope = Callable[[FloatArray, FloatArray, float], FloatArray]
Controller = Callable[[int, FloatArray], FloatArray]


def integrate(slope: Slope, start: FloatArray, drive: FloatArray, sample_time: float) -> FloatArray:
    """States (N, n, E) at the samples of E experiments from `start` (n, E); `drive` (N, 2 · STEPS, E) on half steps."""
    following = np.concatenate([drive[1:, 0], drive[-1:, -1]])
    found = np.empty((len(drive), *start.shape))
    x = start
    for n, half in enumerate(drive):
        found[n] = x
        x = _sample(slope, x, np.concatenate([half, following[n : n + 1]]), n * sample_time, sample_time / STEPS)
    return found


def controlled(
    slope: Slope, start: FloatArray, samples: int, sample_time: float, controller: Controller
) -> tuple[FloatArray, FloatArray]:
    """States (N, n, E) and inputs (N, E) where the input of a sample is held and answers to the state at its start."""
    found, applied = np.empty((samples, *start.shape)), np.empty((samples, start.shape[1]))
    x = start
    for n in range(samples):
        found[n], applied[n] = x, controller(n, x)
        held = np.broadcast_to(applied[n], (2 * STEPS + 1, len(applied[n])))
        x = _sample(slope, x, held, n * sample_time, sample_time / STEPS)
    return found, applied


def _sample(slope: Slope, x: FloatArray, half: FloatArray, t: float, h: float) -> FloatArray:
    for i in range(0, 2 * STEPS, 2):
        k1 = slope(x, half[i], t)
        k2 = slope(x + h / 2 * k1, half[i + 1], t + h / 2)
        k3 = slope(x + h / 2 * k2, half[i + 1], t + h / 2)
        k4 = slope(x + h * k3, half[i + 2], t + h)
        x, t = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), t + h
    return x


def band_limited(amplitudes: FloatArray, lines: np.ndarray, period: int) -> FloatArray:
    """One period (P, 2 · STEPS, E) of Re Σ a_k e^{2πj k t / T} on the half steps, amplitudes (K, E) complex."""
    grid = np.arange(2 * STEPS * period) / (2 * STEPS * period)
    waves = np.real(np.exp(2j * np.pi * np.outer(grid, lines)) @ amplitudes)
    return np.asarray(waves.reshape(period, 2 * STEPS, -1))


def held(samples: FloatArray) -> FloatArray:
    """Samples (N, E) held over their half steps, (N, 2 · STEPS, E)."""
    return np.asarray(np.repeat(samples[:, None], 2 * STEPS, axis=1))
