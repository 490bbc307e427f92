"""Tests of prediction errors: are they white, and do they hold nothing of the past input?"""

import numpy as np
from scipy.linalg import qr
from scipy.signal import lfilter
from scipy.special import chdtrc

from identification.arrays import FloatArray
from identification.likelihood import delayed
from identification.models import RationalStructure
from identification.outcome import TestResult


def chi_square(name: str, statistic: float, degrees_of_freedom: float) -> TestResult:
    """A statistic that is χ² with these degrees of freedom under the null hypothesis; large values speak against it."""
    return TestResult(name, float(statistic), float(degrees_of_freedom), float(chdtrc(degrees_of_freedom, statistic)))


def whiteness(
    structure: RationalStructure, zeta: FloatArray, errors: FloatArray, lags: int | None = None
) -> TestResult | None:
    """Ljung–Box test of the prediction errors ε (N,) of a model ζ (n,) [Ljung1999, (16.74)].

        Q = N (N + 2) Σ_{k=1}^{K} r_k² / (N − k) ~ χ²(K − tr X_K (XᵀX)⁻¹ X_Kᵀ),   r_k the autocorrelation at lag k

    The columns of X are the impulse responses of q^i/C and q^i/D, X_K its first K rows: the fitted noise model takes up
    as many degrees of freedom as its responses within K lags, all n_c + n_d of them when they have died out by then.
    None when the record is too short for at least one degree of freedom or ε vanishes.
    """
    count = lags or _lags(structure, len(errors))
    taken = _absorbed(structure, zeta, count)
    energy = float(errors @ errors)
    if count - taken < 0.5 or energy == 0.0:
        return None
    n = len(errors)
    correlation = np.array([errors[k:] @ errors[:-k] for k in range(1, count + 1)]) / energy
    statistic = n * (n + 2) * np.sum(correlation**2 / (n - np.arange(1, count + 1)))
    return chi_square("whiteness of the prediction errors", float(statistic), count - taken)


def input_independence(
    structure: RationalStructure, errors: FloatArray, jacobian: FloatArray, u: FloatArray, lags: int | None = None
) -> TestResult | None:
    """Test that ε (N,) is uncorrelated with the past inputs u(t − n_k), …, u(t − n_k − K + 1) [Ljung1999, (16.76)].

        ‖Pε‖² (N − n) / ‖ε‖² ~ χ²(rank P),   P the projection on what J = ∂ε/∂ζ leaves of the past inputs

    P accounts for the colour of the input and for the fitted parameters: its rank is K less the directions that the
    fit has used up, and less still for an input of few lines. None when nothing is left to test or ε vanishes.
    """
    count = lags or _lags(structure, len(errors))
    energy = float(errors @ errors)
    fitted = _orthonormal(jacobian)
    past = delayed(u, structure.n_k, count)
    left = past / np.maximum(np.linalg.norm(past, axis=0), np.finfo(float).tiny)
    left = left - fitted @ (fitted.T @ left)
    basis = _orthonormal(left - fitted @ (fitted.T @ left), scaled=False)
    freedom = len(errors) - fitted.shape[1]
    if basis.shape[1] == 0 or freedom <= basis.shape[1] or energy == 0.0:
        return None
    statistic = freedom * float(np.sum((basis.T @ errors) ** 2)) / energy
    return chi_square("independence of prediction errors and past input", statistic, basis.shape[1])


def _lags(structure: RationalStructure, samples: int) -> int:
    return int(min(max(20, structure.size + 10), max(samples // 4, 1)))


def _absorbed(structure: RationalStructure, zeta: FloatArray, lags: int) -> float:
    """tr X_K (XᵀX)⁻¹ X_Kᵀ, between 0 and n_c + n_d."""
    if structure.n_noise == 0:
        return 0.0
    _, _, _, c, d = structure.split(zeta)
    pulse = np.eye(max(20 * lags, 2000), 1).ravel()
    columns = [
        delayed(lfilter([1.0], np.concatenate([[1.0], part]), pulse), 0, len(part)) for part in (c, d) if len(part)
    ]
    return float(np.sum(_orthonormal(np.concatenate(columns, axis=1))[:lags] ** 2))


def _orthonormal(columns: FloatArray, scaled: bool = True) -> FloatArray:
    """An orthonormal basis of the span of the columns, without those that rounding alone holds up."""
    if scaled:
        norms = np.linalg.norm(columns, axis=0)
        columns = columns / np.where(norms > 0, norms, 1.0)
    q, r, _ = qr(columns, mode="economic", pivoting=True, check_finite=False)
    kept = abs(np.diag(r)) > 1e-8
    return np.asarray(q[:, : int(np.sum(kept))])
