"""Signals at other instants than their samples: what a clock that runs fast or slow shows of them."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch

FINER = 16


def interpolated(fine: FloatArray, slope: FloatArray, at: FloatArray, repeats: bool) -> tuple[FloatArray, FloatArray]:
    """Values and derivatives (…, N) at positions (N,) of signals (…, n) with their slopes a step (…, n).

    Cubic between neighbours, with both slopes [deBoor2001, Chapter IV]; around the end where the signal repeats, else
    held there.
    """
    length = fine.shape[-1]
    at = at % length if repeats else np.clip(at, 0.0, length - 1.0)
    left = np.minimum(at.astype(np.int64), length - 1 if repeats else length - 2)
    right = (left + 1) % length
    x = at - left
    a, b, m, n = fine[..., left], fine[..., right], slope[..., left], slope[..., right]
    rise = b - a
    quadratic, cubic = 3 * rise - 2 * m - n, m + n - 2 * rise
    return a + x * (m + x * (quadratic + x * cubic)), m + x * (2 * quadratic + 3 * x * cubic)


def stretched(lines: ComplexArray, batch: Batch, stretch: FloatArray, by_stretch: bool = False) -> ComplexArray:
    """Lines (…, M, K) of y((1 + ε) t), t from the start of the record, for ε = `stretch` (M,); or their ∂/∂ε.

    The mean over the periods of the batch, which begin `begun` seconds after the start; ∂/∂ε is that of t ẏ((1 + ε) t).
    """
    assert batch.signals is not None
    assert batch.sample_time is not None
    length, step = batch.signals.shape[-1], batch.sample_time
    fine = batch.signal(lines, FINER)
    slope = batch.rate(lines, FINER) * (step / FINER)
    count = batch.averaged
    index = np.arange(count * length, dtype=np.float64)
    result = np.empty_like(fine[..., :length])
    for m, epsilon in enumerate(stretch):
        t = index + (0.0 if batch.begun is None else batch.begun[m] / step)
        value, rate = interpolated(fine[..., m, :], slope[..., m, :], FINER * (1 + epsilon) * t, batch.repeats)
        shown = rate * FINER * t if by_stretch else value
        result[..., m, :] = shown.reshape(*shown.shape[:-1], count, length).mean(axis=-2)
    return batch.spectrum(result)
