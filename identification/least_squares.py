"""Levenberg–Marquardt for whitened residuals, with a region that must not be left."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.outcome import Outcome

Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, eq=False)
class LeastSquaresSolution:
    """A minimiser x (n,) of ‖r(x)‖² with r (R,) and J = ∂r/∂x (R, n) there."""

    x: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    outcome: Outcome

    @property
    def cost(self) -> float:
        """‖r(x)‖²."""
        return float(self.residual @ self.residual)

    @property
    def covariance(self) -> FloatArray:
        """(JᵀJ)⁻¹, the covariance of x where r has unit variance; infinite where J has no full column rank."""
        scale, factor = _scaled_factor(self.jacobian)
        if _singular_factor(factor):
            return np.full((len(self.x), len(self.x)), np.inf)
        inverse = np.linalg.inv(factor) / scale[:, None]
        return inverse @ inverse.T


def levenberg_marquardt(
    evaluate: Evaluate,
    start: FloatArray,
    feasible: Callable[[FloatArray], bool] | None = None,
    max_iterations: int = 100,
    tolerance: float = 1e-9,
) -> LeastSquaresSolution:
    """Minimise ‖r(x)‖² where `evaluate(x)` gives r (R,) and J = ∂r/∂x (R, n), never leaving the feasible region.

        (JᵀJ + μ diag JᵀJ) Δ = −Jᵀ r,   stop when the predicted decrease ‖Qᵀr‖² is below `tolerance`² ‖r‖² or rounding

    Each step is solved from a triangular factor of [J r], so that no digits are lost by squaring. The outcome is
    "not_identifiable" when J has no full column rank at the end, "not_converged" after `max_iterations`.
    """
    x = start
    residual, jacobian = evaluate(x)
    damping, status, iterations = 1e-3, "not_converged", 0
    while iterations < max_iterations:
        iterations += 1
        linear = _linearised(residual, jacobian)
        attainable = float(linear.projected @ linear.projected)
        rounding = 1e-26 * float(np.sum((jacobian @ x) ** 2))
        if attainable <= max(tolerance**2 * float(residual @ residual), rounding):
            status = "converged"
            break
        trial = _accepted(evaluate, x, float(residual @ residual), linear, damping, feasible)
        if trial is None:
            status = "converged" if attainable <= 1e-6 * (residual @ residual) else "not_converged"
            break
        x, residual, jacobian, damping = trial
    return LeastSquaresSolution(x, residual, jacobian, _outcome(status, jacobian, iterations))


def _accepted(
    evaluate: Evaluate,
    x: FloatArray,
    cost: float,
    linear: "_Linearised",
    damping: float,
    feasible: Callable[[FloatArray], bool] | None,
) -> tuple[FloatArray, FloatArray, FloatArray, float] | None:
    """The first trial point with a lower cost, with the damping for the next step; None when even tiny steps fail."""
    for _ in range(25):
        trial = x + linear.step(damping)
        if feasible is None or feasible(trial):
            new_residual, new_jacobian = evaluate(trial)
            new_cost = new_residual @ new_residual
            if np.isfinite(new_cost) and new_cost < cost:
                return trial, new_residual, new_jacobian, max(damping / 10, 1e-12)
        damping = 10 * damping
    return None


@dataclass(frozen=True, eq=False)
class _Linearised:
    """‖r + J Δ‖² as ‖projected + triangle (scale Δ)‖² and a constant, J's columns scaled to length one."""

    scale: FloatArray
    triangle: FloatArray
    projected: FloatArray

    def step(self, damping: float) -> FloatArray:
        """The minimiser Δ (n,) with `damping` ‖scale Δ‖² added."""
        n = len(self.scale)
        damped = np.vstack([self.triangle, np.sqrt(damping) * np.eye(n)])
        target = np.concatenate([-self.projected, np.zeros(n)])
        return np.asarray(np.linalg.lstsq(damped, target, rcond=1e-13)[0] / self.scale)


def _linearised(residual: FloatArray, jacobian: FloatArray) -> _Linearised:
    n = jacobian.shape[1]
    scale, factor = _scaled_factor(np.column_stack([jacobian, residual]))
    return _Linearised(scale[:n], factor[:n, :n], factor[:n, n] * scale[n])


def _scaled_factor(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    scale = np.linalg.norm(matrix, axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    columns = matrix.shape[1]
    scaled = matrix / scale
    if len(scaled) < columns:
        scaled = np.vstack([scaled, np.zeros((columns - len(scaled), columns))])
    return scale, np.asarray(np.linalg.qr(scaled, mode="r"))


def is_singular(jacobian: FloatArray) -> bool:
    """Whether J (R, n), its columns scaled to length one, has no full column rank up to rounding."""
    return _singular_factor(_scaled_factor(jacobian)[1])


def _singular_factor(factor: FloatArray) -> bool:
    values = np.linalg.svd(factor, compute_uv=False)
    return bool(values[-1] <= 1e-10 * values[0])


def _outcome(status: str, jacobian: FloatArray, iterations: int) -> Outcome:
    if is_singular(jacobian):
        advice = "the data do not determine all parameters; excite more frequencies or choose a lower order"
        return Outcome("not_identifiable", advice, iterations)
    if status == "converged":
        return Outcome("converged", "", iterations)
    return Outcome(
        "not_converged", "the search stopped before the minimum; choose a lower order or better data", iterations
    )
