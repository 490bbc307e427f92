"""The variance of the mean spectrum of a periodic record, and how well it is known."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_toeplitz

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.comparison.batch import Batch

NEIGHBOURS = 7
ORDER, NUMBERS_EACH = 4, 192
FINER = 4
SMALLEST = 1e-3


@dataclass(frozen=True, eq=False)
class NoiseOfMean:
    """Noise of the mean spectrum of P periods, as it is estimated.

    `variance` σ̂² (K,), at real lines twice that of the real number; `freedom` real degrees of freedom of each;
    `half_width` w; `ends` (2, N), ℓ and ℓ': what correlated noise at the ends of the record adds to the covariance of
    the mean period, −(ℓ ℓ'ᵀ + ℓ' ℓᵀ). `clamped`: lines whose variance was held at a thousandth of what the periods
    differ by around it, because the shape of the spectrum would have put it below.
    """

    variance: FloatArray
    freedom: float
    half_width: int
    ends: FloatArray
    clamped: int = 0


def noise_of_mean(errors: ComplexArray, real: BoolArray) -> NoiseOfMean:
    """From the errors E (P, K) of P periods at every line.

        σ̂_k² = S_k · mean over 2w + 1 lines of s_k'/D_k',   s_k = Σ_p |E_kp − Ē_k|²/(P(P − 1)),   2(P − 1)(2w + 1)

    [PintelonSchoukens2012, Section 2.5] with the shape of the spectrum divided out before lines are pooled: S is an
    autoregression 1/|A(e^{jω})|² fitted to s, D what s then is on average with the leakage of one period and of the
    whole record. Without that a steep spectrum is smeared over the window.
    """
    count, lines = errors.shape
    spread = np.var(errors, axis=0, ddof=1) / count
    spread[0] = spread[1]
    if real[-1]:
        spread[-1] = spread[-2]
    half_width = min(NEIGHBOURS, (int(np.sum(~real)) - 1) // 2)
    period = 2 * lines - (2 if real[-1] else 1)
    covariance, shape = _autoregression(spread, period, count)
    one, whole = (_periodogram(covariance[:length])[:: length // period] for length in (period, len(covariance)))
    expected = np.maximum(one - whole, SMALLEST * one) / (count - 1)
    ratios = spread / expected
    ends = _ends(covariance[:period]) * np.sqrt(np.mean(ratios)) / count
    spectrum = shape / (period * count) * pooled(ratios, half_width, real)
    floor = SMALLEST * pooled(spread, half_width, real)
    variance = np.maximum(spectrum, floor) * np.where(real, 2.0, 1.0)
    clamped = int(np.sum(spectrum < floor))
    return NoiseOfMean(variance, 2.0 * (count - 1) * (2 * half_width + 1), half_width, ends, clamped)


def _autoregression(spread: FloatArray, period: int, count: int) -> tuple[FloatArray, FloatArray]:
    """r (P·N,) up to a factor, of an autoregression that has the spectrum s (K,), and its spectrum 1/|A(e^{jω})|² (K,).

    That is what r folded without end becomes on the lines of the period. White where there is little data.
    """
    order = min(ORDER, len(spread) * (count - 1) // NUMBERS_EACH)
    found = np.fft.irfft(spread, n=period)[: order + 1]
    whole = period * count
    if order == 0 or found[0] <= 0:
        return np.asarray(np.eye(1, whole)[0]), np.ones(len(spread))
    found[0] *= 1 + 1e-9
    polynomial = np.concatenate([[1.0], -solve_toeplitz(found[:order], found[1:])])
    white = abs(np.fft.rfft(polynomial, FINER * whole)) ** 2
    return np.asarray(np.fft.irfft(1 / white)[:whole]), np.asarray(1 / white[:: FINER * count])


def _periodogram(covariance: FloatArray) -> FloatArray:
    """E|rfft(x)/L|² of L samples with this autocovariance (L,): r_τ weighted by L − τ and folded."""
    length = len(covariance)
    lag = np.arange(length)
    folded = (length - lag) * covariance
    folded[1:] += lag[1:] * covariance[:0:-1]
    return np.asarray(np.fft.rfft(folded).real / length**2)


def _ends(covariance: FloatArray) -> FloatArray:
    """ℓ and ℓ' (2, N) with ℓ ℓ'ᵀ ≈ H, H_ij = r(i + j + 1) for i samples from the start and j from the end of a period.

    ℓ ~ H e, with e the first column of H: exact for autoregressions of the first order.
    """
    half = len(covariance) // 2
    values = covariance[1 : 2 * half]
    start = _hankel(values, values[:half])
    size = float(start @ start)
    if size == 0.0:
        return np.zeros((2, len(covariance)))
    value = float(start @ _hankel(values, start)) / size
    padded = np.zeros(len(covariance))
    padded[:half] = start * np.sqrt(abs(value) / size)
    return np.stack([padded, np.sign(value) * padded[::-1]])


def _hankel(values: FloatArray, column: FloatArray) -> FloatArray:
    """Σ_j values_{i+j} column_j (n,) for values (2n − 1,) and a column (n,)."""
    length = 2 * len(column)
    product = np.fft.rfft(values, length) * np.fft.rfft(column, length).conj()
    return np.asarray(np.fft.irfft(product, length)[: len(column)])


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


def variance_of_projection(batches: Sequence[Batch], weights: Sequence[FloatArray], freedom: float) -> float:
    """E (Σ q_i r_i)² with w_i = q_i² of sum one: whitening by variances that were estimated makes it more than one.

        1 + Σ_i w_i 2/(ν_i − 4) (1 − ν_i/ν)

    to first order in the variances of σ̂², with the degrees of freedom ν_i of each σ̂² and ν = `freedom` of them all
    together: lines that were judged too quiet weigh too much. One where a single σ̂² is met, and where all are known.
    """
    excess = 0.0
    for batch, weight in zip(batches, weights, strict=True):
        if np.isfinite(batch.freedom):
            own = 2 / (batch.freedom - 4) * max(1 - batch.freedom / freedom, 0.0)
            excess += float(np.sum(weight)) * own
    return 1 + excess
