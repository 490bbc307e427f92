"""The variance of the mean spectrum of a periodic record, and how well it is known."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_toeplitz

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.comparison.batch import Batch

NEIGHBOURS = 7
ORDER, NUMBERS_EACH = 4, 192
FINER = 4


def variance_of_mean(errors: ComplexArray, real: BoolArray) -> tuple[FloatArray, float, int]:
    """From the errors E (P, K) of P periods at every line: σ̂² (K,), the real degrees of freedom each has, and w.

        σ̂_k² = M_k · mean over 2w + 1 lines of s_k'/D_k',   s_k = Σ_p |E_kp − Ē_k|²/(P(P − 1)),   2(P − 1)(2w + 1)

    [PintelonSchoukens2012, Section 2.5] with the shape of the spectrum divided out before lines are pooled: D_k and M_k
    are what an autoregression fitted to s gives for E s_k and E|Ē_k|², with the leakage of one period and of the whole
    record. Without that a steep spectrum is smeared over the window. At `real` lines σ̂² is twice the variance of the
    real number.
    """
    count, lines = errors.shape
    spread = np.var(errors, axis=0, ddof=1) / count
    spread[0] = spread[1]
    if real[-1]:
        spread[-1] = spread[-2]
    half_width = min(NEIGHBOURS, (int(np.sum(~real)) - 1) // 2)
    between, of_mean = _expected(spread, 2 * lines - (2 if real[-1] else 1), count)
    variance = of_mean * pooled(spread / between, half_width, real) * np.where(real, 2.0, 1.0)
    return variance, 2.0 * (count - 1) * (2 * half_width + 1), half_width


def _expected(spread: FloatArray, period: int, count: int) -> tuple[FloatArray, FloatArray]:
    """D and M (K,) up to a common factor, for noise with the spectrum of an autoregression fitted to s (K,)."""
    order = min(ORDER, len(spread) * (count - 1) // NUMBERS_EACH)
    covariance = np.fft.irfft(spread, n=period)[: order + 1]
    if order == 0 or covariance[0] <= 0:
        return np.ones_like(spread), np.ones_like(spread)
    covariance[0] *= 1 + 1e-9
    polynomial = np.concatenate([[1.0], -solve_toeplitz(covariance[:order], covariance[1:])])
    whole = period * count
    white = abs(np.fft.rfft(polynomial, FINER * whole)) ** 2
    covariance = np.fft.irfft(1 / white)[:whole]
    one, every = (_periodogram(covariance[:length]) for length in (period, whole))
    of_mean = every[::count][: len(spread)]
    return (one - of_mean) / (count - 1), of_mean


def _periodogram(covariance: FloatArray) -> FloatArray:
    """E|rfft(x)/L|² of L samples with this autocovariance (L,): r_τ weighted by L − τ and folded."""
    length = len(covariance)
    lag = np.arange(length)
    folded = (length - lag) * covariance
    folded[1:] += lag[1:] * covariance[:0:-1]
    return np.asarray(np.fft.rfft(folded).real / length**2)


def _starts(half_width: int, real: BoolArray) -> IntArray:
    """The first line of each window (K,): centred, but moved inwards at the ends, where `real` lines are left out."""
    lines = np.arange(len(real))
    if half_width == 0:
        return lines
    inner = np.flatnonzero(~real)
    return np.asarray(np.clip(lines - half_width, inner[0], inner[-1] - 2 * half_width))


def pooled(values: FloatArray, half_width: int, real: BoolArray) -> FloatArray:
    """Means of values (K,) over the windows of 2 `half_width` + 1 lines."""
    width, starts = 2 * half_width + 1, _starts(half_width, real)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray((sums[starts + width] - sums[starts]) / width)


def spread_back(weights: FloatArray, half_width: int, real: BoolArray) -> FloatArray:
    """The adjoint of `pooled`: weights (…, K) of pooled values as weights of the values themselves."""
    width, starts, lines = 2 * half_width + 1, _starts(half_width, real), np.arange(len(real))
    begun, ended = (np.searchsorted(first, lines, side="right") for first in (starts, starts + width))
    sums = np.concatenate([np.zeros((*weights.shape[:-1], 1)), np.cumsum(weights, axis=-1)], axis=-1)
    return np.asarray((sums[..., begun] - sums[..., ended]) / width)


def noise_freedom(batches: Sequence[Batch], weights: Sequence[FloatArray]) -> float:
    """Degrees of freedom ν of Σ w_i r_i², w ≥ 0 of sum one, as far as the noise variances are random.

        2/ν = var Σ_k w_k δ_k = Σ_k (window* w)_k² 2/ν₁,   δ_k the mean of the relative errors in the window of line k

    ν₁ are the degrees of freedom that each line brings; infinite when the variances are known.
    """
    total = 0.0
    for batch, weight in zip(batches, weights, strict=True):
        if np.isinf(batch.raw_freedom):
            continue
        lines = weight.reshape(len(batch.points), 2, -1).sum(axis=1)
        total += float(np.sum(spread_back(lines, batch.half_width, batch.real) ** 2)) / batch.raw_freedom
    return 1 / total if total > 0 else np.inf
