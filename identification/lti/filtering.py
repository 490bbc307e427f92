"""Rational filters in discrete time."""

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import FloatArray


def lfilter(numerator: ArrayLike, denominator: ArrayLike, signal: ArrayLike, axis: int = -1) -> FloatArray:
    """v = (Σ n_i q^i / Σ d_i q^i) u along `axis`, q the delay by one sample, zero before the first sample.

    Loads scipy.signal with its first call only: loading takes a second, and who describes models need not filter.
    """
    from scipy import signal as filters

    n, d, u = (np.asarray(values, dtype=np.float64) for values in (numerator, denominator, signal))
    return np.asarray(filters.lfilter(n, d, u, axis=axis), dtype=np.float64)
