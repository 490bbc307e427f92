"""The design as the paper writes it, one large linear matrix inequality: the reference for the certified solver.

Slow, and without a certificate of its own; needs cvxpy, which nothing else here does.
"""

from dataclasses import dataclass
from typing import Any

import cvxpy
import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.outcome import Outcome
from oed.information import sensitivity_moments
from oed.problem import DecisionTarget, DesignProblem
from oed.spectra.fir import FirSpectra

MIDPOINTS = 20_000


@dataclass(frozen=True, eq=False)
class DirectDesign:
    """Energy J, infinite when infeasible, and the coefficients N_p c_{m,i} (M, L + 1) of the spectra."""

    outcome: Outcome
    total_energy: float
    coefficients: FloatArray


def direct_design(problem: DesignProblem) -> DirectDesign:
    """Solve, over the coefficients of FIR spectra at all grid points at once,

        min Σ_m c_{m,0}   s.t.   Σ_m (c_{m,0} X_{m,0} + 2 Σ_i c_{m,i} X_{m,i}) + P_G⁻¹ ⪰ R_j,   c_{m,0} ≤ α_m,
        Φ_m ≥ 0 as  c_{m,i} = Σ_s [Q_m]_{s,s+i},  Q_m ⪰ 0                          [Ghosh2018, (15), (19), (20)]
        c_{m,0} w_{m,0} + 2 Σ_i c_{m,i} w_{m,i} ≤ N_p for every limit of the plant

    with X_{m,i} = (1/2π) ∫ Re(a a*) cos(iω) dω, w_{m,i} likewise of what the limit weighs, and c in units of energy.
    Raises MisuseError for other families than
    FIR spectra and for a box.
    """
    if not isinstance(problem.family, FirSpectra) or problem.box or problem.model.effects:
        raise MisuseError("the inequality as written is for FIR spectra on a grid, without effects", "family")
    degree, model = problem.family.degree, problem.model
    k = model.plant_size
    moments = sensitivity_moments(model, problem.points, degree, problem.step)
    targets = np.concatenate(
        [target.matrices(model) for target in problem.targets if not isinstance(target, DecisionTarget)]
    )[:, :k, :k]
    basis = np.linalg.inv(np.linalg.cholesky(moments[:, 0].sum(axis=0))).T
    moments, targets = basis.T @ moments @ basis, basis.T @ targets @ basis
    energy = float(np.linalg.eigvalsh(targets)[:, -1].max())
    coefficients = cvxpy.Variable((len(problem.points), degree + 1))
    information = _information(moments, coefficients)
    prior = basis.T @ problem.prior[:k, :k] @ basis / energy
    constraints = [information + prior >> target / energy for target in targets]
    constraints += [positive for m in range(len(problem.points)) for positive in _positive(coefficients[m], degree)]
    constraints += [coefficients[m, 0] <= cap / energy for m, cap in enumerate(problem.limits) if np.isfinite(cap)]
    if problem.plant_limits:
        taken = _limit_moments(problem, degree)
        room = problem.samples / energy
        constraints += [coefficients[m] @ row <= room for each in taken for m, row in enumerate(each) if row.any()]
    task = cvxpy.Problem(cvxpy.Minimize(cvxpy.sum(coefficients[:, 0])), constraints)
    task.solve(solver=cvxpy.CLARABEL)
    if coefficients.value is None:
        return DirectDesign(Outcome("infeasible", f"the solver answers {task.status}"), np.inf, np.zeros((0, 0)))
    accurate = task.status == cvxpy.OPTIMAL
    outcome = Outcome("converged") if accurate else Outcome("not_converged", f"the solver answers {task.status}")
    return DirectDesign(outcome, float(task.value) * energy, coefficients.value * energy)


def _limit_moments(problem: DesignProblem, degree: int) -> FloatArray:
    """The moments (L, M, degree + 1) of the shares that limits weigh, twice those above zero, by the midpoint rule."""
    phase = (np.arange(MIDPOINTS) + 0.5) * np.pi / MIDPOINTS
    cosines = np.cos(np.outer(phase, np.arange(degree + 1))) * np.where(np.arange(degree + 1) == 0, 1.0, 2.0)
    return np.asarray(problem.share(phase / problem.step) @ cosines / MIDPOINTS)


def _information(moments: FloatArray, coefficients: cvxpy.Variable) -> Any:
    k = moments.shape[-1]
    weighted = moments * np.where(np.arange(moments.shape[1]) == 0, 1.0, 2.0)[:, None, None]
    matrix = weighted.reshape(-1, k * k).T
    return cvxpy.reshape(matrix @ cvxpy.vec(coefficients, order="C"), (k, k), order="C")


def _positive(coefficients: Any, degree: int) -> list[Any]:
    """c_i is the sum of the i-th diagonal of a positive semidefinite matrix."""
    gram = cvxpy.Variable((degree + 1, degree + 1), PSD=True)
    sums = [cvxpy.sum(cvxpy.diag(gram, i)) for i in range(degree + 1)]
    return [coefficients == cvxpy.hstack(sums)]
