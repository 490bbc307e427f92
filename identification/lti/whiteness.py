"""Tests of prediction errors: are they white, and do they hold nothing of the past input?"""

import numpy as np
from scipy.linalg import qr
from scipy.special import chdtrc

from identification.arrays import FloatArray
from identification.lti.filtering import lfilter
from identification.lti.likelihood import delayed
from identification.models.rational import RationalStructure
from identification.outcome import TestResult


def chi_square(name: str, statistic: float, degrees_of_freedom: float) -> TestResult:
    """A statistic that is χ² with these degrees of freedom under the null hypothesis; large values speak against it."""
    return TestResult(name, float(statistic), float(degrees_of_freedom), float(chdtrc(degrees_of_freedom, statistic)))


def whiteness(
    structure: RationalStructure,
    zeta: FloatArray,
    covariance: FloatArray,
    errors: FloatArray,
    lags: int | None = None,
    taken: int = 0,
) -> TestResult | None:
    """Ljung–Box test of the prediction errors ε (N,) of a model ζ (n,) with covariance P_ζ (n, n) [Ljung1999, 16.6].

        Q = N (N + 2) Σ_{k=1}^{K} r_k² / (N − k) ~ χ²(K − N tr X_K P_H X_Kᵀ),   r_k the autocorrelation at lag k

    P_H is the block of ζ_H in P_ζ; the columns of X_K are the first K values of the impulse responses −q^i/C and q^i/D,
    by which r changes with ζ_H. So the fitted noise model takes up n_c + n_d degrees of freedom when its responses die
    out within K lags, and fewer when they do not or when other experiments have helped to fit it. `taken`: parameters
    of a noise model that is no part of ζ. None when the record is too short for at least one degree of freedom, P_ζ is
    not finite, or ε vanishes.
    """
    count = lags or _lags(structure, len(errors)) + taken
    energy = float(errors @ errors)
    noise = covariance[structure.n_plant :, structure.n_plant :]
    if energy == 0.0 or not np.all(np.isfinite(noise)):
        return None
    n = len(errors)
    columns = _noise_responses(structure, zeta, count)
    freedom = count - taken - min(n * float(np.sum((columns @ noise) * columns)), structure.n_noise)
    if freedom < 1:
        return None
    correlation = np.array([errors[k:] @ errors[:-k] for k in range(1, count + 1)]) / energy
    statistic = n * (n + 2) * np.sum(correlation**2 / (n - np.arange(1, count + 1)))
    return chi_square("whiteness of the prediction errors", float(statistic), freedom)


def input_independence(
    structure: RationalStructure, errors: FloatArray, jacobian: FloatArray, u: FloatArray, lags: int | None = None
) -> TestResult | None:
    """Test that ε (N,) is uncorrelated with the past inputs u(t − n_k), …, u(t − n_k − K + 1) [Ljung1999, 16.6].

        ‖Pε‖² (N − n) / ‖ε‖² ~ χ²(rank P),   P the projection on what J = ∂ε/∂ζ leaves of the past inputs

    P accounts for the colour of the input and for the fitted parameters: its rank is K less the directions that the
    fit has used up, and less still for an input of few lines. None when nothing is left to test or ε vanishes.
    """
    count = lags or _lags(structure, len(errors))
    energy = float(errors @ errors)
    fitted = orthonormal(jacobian)
    past = delayed(u, structure.n_k, count)
    left = past / np.maximum(np.linalg.norm(past, axis=0), np.finfo(float).tiny)
    left = left - fitted @ (fitted.T @ left)
    basis = orthonormal(left - fitted @ (fitted.T @ left), scaled=False)
    freedom = len(errors) - fitted.shape[1]
    if basis.shape[1] == 0 or freedom <= basis.shape[1] or energy == 0.0:
        return None
    statistic = freedom * float(np.sum((basis.T @ errors) ** 2)) / energy
    return chi_square("independence of prediction errors and past input", statistic, basis.shape[1])


def _lags(structure: RationalStructure, samples: int) -> int:
    return int(min(max(20, structure.size + 10), max(samples // 4, 1)))


def _noise_responses(structure: RationalStructure, zeta: FloatArray, lags: int) -> FloatArray:
    _, _, _, c, d = structure.split(zeta)
    pulse = np.eye(lags, 1).ravel()
    of_c, of_d = (lfilter([1.0], np.concatenate([[1.0], part]), pulse) for part in (c, d))
    return np.concatenate([-delayed(of_c, 0, len(c)), delayed(of_d, 0, len(d))], axis=1)


def orthonormal(columns: FloatArray, scaled: bool = True) -> FloatArray:
    """An orthonormal basis of the span of the columns, without those that rounding alone holds up."""
    if scaled:
        norms = np.linalg.norm(columns, axis=0)
        columns = columns / np.where(norms > 0, norms, 1.0)
    q, r, _ = qr(columns, mode="economic", pivoting=True, check_finite=False)
    kept = abs(np.diag(r)) > 1e-8
    return np.asarray(q[:, : int(np.sum(kept))])
