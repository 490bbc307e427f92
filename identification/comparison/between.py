"""What lies between the harmonics of a periodic record: noise, and lines of machines nearby."""

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.special import fdtrc

from identification.arrays import FloatArray
from identification.outcome import TestResult

NEIGHBOURS = 15
STEEP = 4.0


def flattened(powers: FloatArray, frequency: FloatArray) -> FloatArray:
    """Powers (n,) at frequencies (n,), cycles a sample; those of the differences of samples where that is flatter.

    A sine wave stays one; a level that wanders, whose spectrum falls like 1/ω², becomes white. It is taken to wander
    where the median of the lowest lines is `STEEP` times that of the next.
    """
    low, next_ = powers[:NEIGHBOURS], powers[NEIGHBOURS : 3 * NEIGHBOURS]
    if len(next_) < 2 * NEIGHBOURS or np.median(low) < STEEP * np.median(next_):
        return powers
    return np.asarray(powers * np.sin(np.pi * frequency) ** 2)


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
