"""What lies between the harmonics of a periodic record: noise, and lines of machines nearby."""

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d
from scipy.special import fdtrc

from identification.arrays import FloatArray
from identification.outcome import TestResult

NEIGHBOURS = 15
LOWEST = 60
CORNERS = (0.0, 1.5, 3.0, 6.0, 12.0, 24.0, 48.0)
FLOORS = (0.0, 1.0, 4.0, 16.0, 64.0)
WANDERING, WORTH = 3.0, 6.0


def flattened(powers: FloatArray, lines: FloatArray, length: int) -> FloatArray:
    """Powers (n,) at the lines (n,) of a record of so many samples; those of its differences where it wanders.

    A sine wave stays one; a level that wanders, whose spectrum falls like 1/ω², becomes white.
    """
    if corner(powers, lines) > WANDERING:
        return powers
    return np.asarray(powers * np.sin(np.pi * lines / length) ** 2)


def corner(powers: FloatArray, lines: FloatArray) -> float:
    """The line below which the spectrum of a level that comes back flattens out; 0: it never does, ∞: it is white.

        S(k) ∝ 1/(k² + c²) + b,   by Whittle's likelihood of powers (n,) at the lowest lines (n,), over c and b

    Single lines that stand out are cut to ten times the median around them [Whittle1953].
    """
    k, x = lines[:LOWEST], powers[:LOWEST]
    if len(k) < LOWEST or not np.all(x > 0):
        return np.inf
    x = np.minimum(x, 10 * median_filter(x, 2 * NEIGHBOURS // 2 + 1, mode="nearest"))
    fits = [(_whittle(x, np.ones(len(k))), np.inf)]
    for c in CORNERS:
        falling = 1 / (k**2 + c**2)
        fits += [(_whittle(x, falling + b * falling[-1]) + WORTH, c) for b in FLOORS]
    return min(fits)[1]


def _whittle(powers: FloatArray, shape: FloatArray) -> float:
    return float(len(powers) * np.log(np.mean(powers / shape)) + np.sum(np.log(shape)))


def standing_out(powers: FloatArray) -> FloatArray:
    """Powers (n,) over the mean of the thirty around each; all zero where there are fewer."""
    width = 2 * NEIGHBOURS + 1
    if len(powers) < width:
        return np.zeros(len(powers))
    around = (uniform_filter1d(powers, width, mode="reflect") * width - powers) / (width - 1)
    return np.asarray(powers / np.maximum(around, np.finfo(np.float64).tiny))


def strongest_line(powers: FloatArray) -> TestResult:
    """Whether one line between the harmonics, of powers (n,), stands out from the thirty around it.

        x_k/mean of 30 neighbours ~ F(2, 60),   p = 1 − (1 − min p_k)ⁿ

    Small p: a disturbance with a frequency of its own, such as mains hum. Assumes noise that is flat over the window.
    """
    name = "line between the harmonics"
    ratio = standing_out(powers)
    if not np.any(ratio):
        return TestResult(name, 0.0, 0.0, 1.0)
    least = float(np.min(fdtrc(2, 4 * NEIGHBOURS, ratio)))
    return TestResult(name, float(ratio.max()), 2.0, float(-np.expm1(len(powers) * np.log1p(-min(least, 1 - 1e-16)))))
