"""What lies between the harmonics of a periodic record: noise, and lines of machines nearby."""

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.special import fdtrc

from identification.arrays import FloatArray
from identification.outcome import TestResult

NEIGHBOURS = 15


def strongest_line(powers: FloatArray) -> TestResult:
    """Whether one line between the harmonics, of powers (n,), stands out from the thirty around it.

        x_k/mean of 30 neighbours ~ F(2, 60),   p = 1 − (1 − min p_k)ⁿ

    Small p: a disturbance with a frequency of its own, such as mains hum. Assumes noise that is flat over the window.
    """
    width = 2 * NEIGHBOURS + 1
    name = "line between the harmonics"
    if len(powers) < width:
        return TestResult(name, 0.0, 0.0, 1.0)
    around = (uniform_filter1d(powers, width, mode="reflect") * width - powers) / (width - 1)
    ratio = powers / np.maximum(around, np.finfo(np.float64).tiny)
    least = float(np.min(fdtrc(2, 4 * NEIGHBOURS, ratio)))
    return TestResult(name, float(ratio.max()), 2.0, float(-np.expm1(len(powers) * np.log1p(-min(least, 1 - 1e-16)))))
