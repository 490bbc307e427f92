"""The spectrum of noise as an autoregression whose order the data choose."""

import numpy as np

from identification.arrays import FloatArray

LARGEST, SAMPLES_EACH = 30, 30


def autoregressive_spectrum(powers: FloatArray, samples: int) -> tuple[FloatArray, int]:
    """σ²/|1 + Σ d_i e^{−jωi}|² at the lines, from powers |E_k|² (K,) of `samples` values, and the order.

    Levinson's recursion on the circular autocovariance; the order has the least N ln σ² + i ln N [Schwarz1978],
    i ≤ 30 and N/30. The mean over all lines is that of the powers.
    """
    covariance = np.fft.irfft(powers, n=samples)
    polynomial, variance = np.ones(1), float(covariance[0])
    if variance <= 0:
        return np.full(len(powers), np.finfo(np.float64).tiny), 0
    best, kept = samples * np.log(variance), polynomial
    for order in range(1, min(LARGEST, samples // SAMPLES_EACH) + 1):
        reflection = -float(polynomial @ covariance[order:0:-1]) / variance
        polynomial = np.append(polynomial, 0.0) + reflection * np.append(0.0, polynomial[::-1])
        variance *= 1 - reflection**2
        if variance <= 0:
            break
        cost = samples * np.log(variance) + order * np.log(samples)
        if cost < best:
            best, kept = cost, polynomial
    shape = 1 / abs(np.fft.rfft(kept, samples)) ** 2
    twice = np.full(len(powers), 2.0)
    twice[0] = 1.0
    if samples % 2 == 0:
        twice[-1] = 1.0
    return np.asarray(shape * (twice @ powers) / (twice @ shape)), len(kept) - 1
