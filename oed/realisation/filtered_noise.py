"""Filtered noise: a stationary Gaussian signal with the designed spectrum on average."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import fftconvolve

from identification.arrays import FloatArray, finite_floats
from identification.errors import RangeError
from oed.realisation.spectral_factor import spectral_factor


def filtered_noise(coefficients: ArrayLike, samples: int, generator: np.random.Generator | int) -> FloatArray:
    """N samples of Gaussian noise whose energy spectrum is the designed one in expectation.

        u(t) = Σ_i h_i e(t−i),   E u(t)u(t+i) = c_i/N,   N Φ_u(ω) = c_0 + 2 Σ_i c_i cos(iω)   [Ghosh2018, (20)]

    `coefficients` c_0..c_L (L+1,) are energies (the unit of u²) of the whole record, and e is white with unit variance.
    The record is stationary from its first sample. Its energy Σ u(t)² is random with mean c_0 and standard deviation
    `energy_deviation`, and so is its periodogram; a multisine has the designed energy exactly.

    Raises RangeError for fewer than one sample, else as `spectral_factor`.
    """
    if samples < 1:
        raise RangeError(f"samples: a record needs at least one sample, not {samples}", "samples")
    h = spectral_factor(coefficients) / np.sqrt(samples)
    white = np.random.default_rng(generator).standard_normal(samples + len(h) - 1)
    return np.asarray(fftconvolve(white, h, mode="valid"), dtype=np.float64)


def energy_deviation(coefficients: ArrayLike, samples: int) -> float:
    """The standard deviation of the energy Σ u(t)² of N samples of `filtered_noise`, in the unit of the energy.

    √(2 Σ_{|i| ≤ min(L, N−1)} (N − |i|) (c_i/N)²)
    """
    c = finite_floats(coefficients, "coefficients")[:samples] / samples
    weights = np.where(np.arange(len(c)) == 0, 1.0, 2.0) * (samples - np.arange(len(c)))
    return float(np.sqrt(2.0 * np.sum(weights * c**2)))
