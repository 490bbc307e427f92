"""Spectral factorisation: from the autocovariances of a designed spectrum to the filter that produces it."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft
from scipy.linalg import hankel, toeplitz

from identification.arrays import FloatArray, finite_floats
from identification.errors import RangeError, ShapeError

ROUNDING = 1e-6  # of c_0: how far a spectrum may dip below zero and still count as one that touches it
LIFT = 1e-12  # of c_0: what is added so that zeros on the unit circle come off it
ACCURACY = 1e-9  # of c_0: how well the filter must reproduce the coefficients


def spectral_factor(coefficients: ArrayLike) -> FloatArray:
    """The minimum-phase filter h (L+1,) whose output for unit white noise has the autocovariances c_0..c_L.

        Σ_j h_j h_{j+i} = c_i,   |Σ_i h_i e^{−iω}|² = c_0 + 2 Σ_i c_i cos(iω)

    Newton's method on the equation itself [Wilson1969], quadratic for a positive spectrum. Optimal spectra touch
    zero; there it halves the error in a step, so a spectrum is first lifted above zero by 1e-12 c_0 and by as much as
    it dips below. The factor meets the coefficients within 1e-9 c_0 (plus twice that dip), and c_0 to rounding.

    Raises ShapeError unless there is one row of at least one coefficient, and RangeError when they are not finite,
    c_0 is not positive, or the spectrum is negative by more than 1e-6 c_0.
    """
    c = finite_floats(coefficients, "coefficients")
    if c.ndim != 1 or c.size == 0:
        raise ShapeError(f"coefficients: give one row c_0..c_L, not an array of shape {c.shape}", "coefficients")
    if c[0] <= 0.0:
        raise RangeError(f"coefficients: c_0 = {c[0]} is the energy and must be positive", "coefficients")
    dip = _dip(c / c[0])
    lifted = c / c[0]
    lifted[0] += 1.1 * dip + LIFT
    h = _wilson(lifted)
    error = float(np.abs(_autocovariance(h) - c / c[0]).max())
    if error > ACCURACY + 2.0 * dip:
        raise RangeError(
            f"coefficients: the spectrum could be factored to {error:.0e} of c_0 only; lower the degree", "coefficients"
        )
    return np.asarray(h * np.sqrt(c[0] / np.sum(h**2)), dtype=np.float64)


def _dip(c: FloatArray) -> float:
    """How far c_0 + 2Σ c_i cos(iω) falls below zero, with its minima taken between the points of a fine grid."""
    points = 64 * len(c)
    density = 2.0 * fft.rfft(c, points).real - c[0]
    padded = np.pad(density, 1, mode="reflect")
    lowest = np.flatnonzero((density <= padded[:-2]) & (density <= padded[2:]))
    frequencies = _nearest_minima(c, 2.0 * np.pi * lowest / points, 2.0 * np.pi / points)
    minima = 2.0 * np.cos(np.outer(frequencies, np.arange(len(c)))) @ c - c[0]
    at = int(np.argmin(minima))
    if minima[at] < -ROUNDING:
        raise RangeError(
            f"coefficients: the spectrum is negative ({minima[at]:.2g} c_0) at ω = {frequencies[at]:.4g} rad/sample,"
            " so it is the spectrum of no signal",
            "coefficients",
        )
    return max(0.0, -float(minima[at]))


def _nearest_minima(c: FloatArray, frequencies: FloatArray, spacing: float) -> FloatArray:
    """The minima of c_0 + 2Σ c_i cos(iω) next to `frequencies`, by Newton steps within the spacing of the grid."""
    lag = np.arange(len(c))
    nearest = frequencies
    for _ in range(4):
        angles = np.outer(nearest, lag)
        slope = -np.sin(angles) @ (lag * c)
        bend = -np.cos(angles) @ (lag**2 * c)
        step = np.divide(slope, bend, out=np.zeros(len(slope)), where=bend > 1e-12)
        nearest = np.clip(nearest - step, frequencies - spacing, frequencies + spacing)
    return nearest


def _wilson(c: FloatArray, iterations: int = 100) -> FloatArray:
    h: FloatArray = np.zeros(len(c))
    h[0] = np.sqrt(c[0])
    best, lowest, stalled = h, np.inf, 0
    for _ in range(iterations):
        try:
            h = _newton_step(h, c)
        except np.linalg.LinAlgError:
            break
        error = float(np.abs(_autocovariance(h) - c).max())
        stalled = stalled + 1 if error >= lowest else 0
        if error < lowest:
            best, lowest = h, error
        if lowest < 1e-15 or stalled > 15:
            break
    return best


def _newton_step(h: FloatArray, c: FloatArray) -> FloatArray:
    """The x for which Σ_j (h_j x_{j+i} + x_j h_{j+i}) = c_i + Σ_j h_j h_{j+i}."""
    column = np.append(h[0], np.zeros(len(h) - 1))
    return np.asarray(np.linalg.solve(toeplitz(column, h) + hankel(h), c + _autocovariance(h)), dtype=np.float64)


def _autocovariance(h: FloatArray) -> FloatArray:
    return np.asarray(np.correlate(h, h, "full")[len(h) - 1 :], dtype=np.float64)
