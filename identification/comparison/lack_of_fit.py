"""Lack of fit held against its distribution."""

import numpy as np
from scipy.special import chdtrc, fdtrc

from identification.outcome import TestResult


def lack_of_fit(name: str, energy: float, freedom: float, noise_freedom: float) -> TestResult:
    """‖r‖² of whitened residuals with `freedom` degrees of freedom left by the fit; the statistic is that sum.

    ‖r‖²/d ~ F(d, ν)   where the noise variances were estimated with ν degrees of freedom, χ²(d)/d where known
    """
    if freedom < 0.5:
        return TestResult(name, energy, 0.0, 1.0)
    if np.isinf(noise_freedom):
        return TestResult(name, energy, freedom, float(chdtrc(freedom, energy)))
    centred = energy / freedom * noise_freedom / max(noise_freedom - 2, 1.0)
    return TestResult(name, energy, freedom, float(fdtrc(freedom, noise_freedom, centred)))
