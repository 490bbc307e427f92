"""Maximum likelihood of state-space models from records along p(t) with white output noise."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from scipy.linalg import solve_triangular

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError, RangeError, ShapeError
from identification.estimates import Estimate, Found
from identification.least_squares import levenberg_marquardt
from identification.models.model import Model
from identification.models.recursion import propagate
from identification.models.state_space import Matrices
from identification.outcome import Outcome
from identification.scheduling import ProductBasis
from identification.varying.progress import Progress, Steps, silent, within
from identification.varying.records import VaryingRecord
from identification.varying.scheduled import Scheduled, Signals
from identification.varying.stacks import StackSizes, along, balancing, simulated, transformed

ROUNDS, MOST_ROUNDS = 4, 16
LARGE = 1e100


@dataclass(frozen=True, eq=False, kw_only=True)
class OutputErrorFound(Found):
    """The covariance Σ_w (n_y, n_y) of the noise, the errors y − ŷ (N, n_y) and the first state (n_x,)."""

    noise_covariance: FloatArray
    errors: FloatArray
    initial_state: FloatArray


@dataclass(frozen=True)
class OutputError:
    """Maximum likelihood in the time domain from a model near it, for white noise and scheduling of any kind.

    See `output_error`.
    """

    kind: ClassVar[str] = "output_error"

    max_iterations: Annotated[int, "most iterations in each round, after which the noise is weighed anew"] = 30

    def __post_init__(self) -> None:
        if self.max_iterations < 1:
            raise RangeError(f"max_iterations is {self.max_iterations}; it must be one or more", "max_iterations")

    def estimate(
        self,
        record: VaryingRecord,
        order: int | None,
        start: Model,
        *,
        basis: ProductBasis | None = None,
        progress: Progress = silent,
    ) -> Estimate:
        """The estimate of a record, with OutputErrorFound; order and basis are those of the start.

        Raises ShapeError for a start of other sizes, MisuseError for one over other functions, and as `output_error`.
        """
        if order not in (None, start.structure.order):
            raise ShapeError(f"the start has order {start.structure.order}, {order} is asked for", "start")
        scheduled = Scheduled.of(record, basis, start)
        first = scheduled.matrices(start, start.structure.order)
        fit = output_error(first, scheduled.signals, self.max_iterations, progress)
        found = OutputErrorFound(
            noise_covariance=fit.noise_covariance, errors=fit.errors, initial_state=fit.initial_state
        )
        return Estimate(scheduled.model(fit.matrices, fit.covariance, fit.noise_variance), fit.outcome, (), found=found)

    @classmethod
    def example(cls) -> "OutputError":
        """A small one, for the conformance tests."""
        return cls()


@dataclass(frozen=True, eq=False)
class OutputErrorFit:
    """The stacks with the covariance (size, size) of their entries, and what `OutputErrorFound` tells."""

    matrices: Matrices
    outcome: Outcome
    covariance: FloatArray | None
    noise_covariance: FloatArray
    errors: FloatArray
    initial_state: FloatArray

    @property
    def noise_variance(self) -> float:
        """Of the only output; one where there are several."""
        return float(self.noise_covariance[0, 0]) if len(self.noise_covariance) == 1 else 1.0


def output_error(
    start: Matrices, record: Signals, max_iterations: int = 30, progress: Progress = silent
) -> OutputErrorFit:
    """The output-error estimate from stacks near it: maximum likelihood when the noise is white and Gaussian.

        θ̂, x̂(0) = arg min Σ_t ‖Σ_w^{-½} (y(t) − ŷ(t, θ, x(0)))‖²,   P_θ = Q (QᵀJᵀJQ)⁻¹ Qᵀ

    All matrices are free; θ moves in the orthogonal complement Q of what a change of state coordinates does to first
    order, A_kT − TA_k, −TB_k, C_kT, at the start of each round, so that JQ has full rank. Σ_w is the covariance of the
    errors of the round before, at least 1e-20 of the output's mean square; a round that did not reach its minimum is
    followed by one in a balanced state basis. The record may begin in any state. Raises NotIdentifiableError with fewer
    values of the output than parameters.
    """
    _require_enough(start, record)
    matrices, iterations = start, 0
    initial: FloatArray = np.zeros(start[0].shape[1])
    floor = 1e-20 * np.maximum(np.mean(record.output**2, axis=0), np.finfo(float).tiny)
    errors = record.output - simulated(matrices, record.input, record.phi, initial)[1]
    weighed = 0
    for i in range(MOST_ROUNDS):
        steps = Steps(within(progress, i / MOST_ROUNDS, (i + 1) / MOST_ROUNDS), f"likelihood, round {i + 1}")
        problem = _Problem(matrices, initial, record, errors.T @ errors / len(errors) + np.diag(floor), floor)
        solution = levenberg_marquardt(steps.of(problem.evaluate), np.zeros(problem.size), None, max_iterations, 1e-4)
        iterations += solution.outcome.iterations
        matrices, initial = problem.matrices(solution.x), problem.state(solution.x)
        errors = record.output - simulated(matrices, record.input, record.phi, initial)[1]
        if np.all(np.mean(errors**2, axis=0) < floor) or solution.outcome.status == "not_identifiable":
            break
        if solution.outcome.status == "converged":
            weighed += 1
            if weighed == ROUNDS or solution.cost > (1 - 1e-6) * errors.size:
                break
        elif i + 1 < MOST_ROUNDS:
            basis = balancing(matrices)
            matrices = transformed(matrices, basis)
            initial = np.linalg.solve(basis, initial).astype(np.float64)
    outcome = Outcome(solution.outcome.status, solution.outcome.advice, iterations)
    known = outcome.status != "not_identifiable"
    of_model = slice(0, problem.sizes.free)
    covariance = problem.chart @ solution.covariance[of_model, of_model] @ problem.chart.T if known else None
    return OutputErrorFit(matrices, outcome, covariance, errors.T @ errors / len(errors), errors, initial)


def _require_enough(start: Matrices, record: Signals) -> None:
    parameters = StackSizes.of(start).size
    if record.output.size <= parameters:
        raise NotIdentifiableError(
            f"{record.output.size} values of the output cannot determine {parameters} parameters; record longer or"
            " choose a lower order",
            "output",
        )


class _Problem:
    """Whitened errors and their derivative with respect to (β, ξ), θ = θ_start + Q β, x(0) = `initial` + ξ.

    A thousand times the size of the states is the deviation of x(0) in advance: what nothing shows of it stays at zero.
    """

    def __init__(
        self,
        start: Matrices,
        initial: FloatArray,
        record: Signals,
        noise: FloatArray,
        floor: FloatArray,
    ) -> None:
        self.sizes, self.initial = StackSizes.of(start), initial
        self.size = self.sizes.free + self.sizes.order
        states = simulated(start, record.input, record.phi)[0]
        size = float(np.sqrt(np.mean(np.minimum(states**2, LARGE**2), where=np.isfinite(states))))
        self.spread = 1e3 * (size or 1.0)
        self.start = self.sizes.join(start)
        self.chart = self.sizes.chart(self.start)
        self.record, self.root = record, np.linalg.cholesky(noise).astype(np.float64)
        # One constant residual of the size of rounding, so that the search ends when only rounding is left.
        self.rounding = float(np.sqrt(len(record) * np.sum(floor / np.diag(noise))))

    def matrices(self, beta: FloatArray) -> Matrices:
        """A, B, C, D at β."""
        return self.sizes.split(self.start + self.chart @ beta[: self.sizes.free])

    def state(self, beta: FloatArray) -> FloatArray:
        """x(0) at (β, ξ)."""
        return self.initial + beta[self.sizes.free :]

    def evaluate(self, beta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Zᵀr (n_θ + n_x + 2,) and Zᵀ ∂r/∂(β, ξ), from a triangular factor of both; infinite where it blows up.

        The long residual itself is not needed: its norm and the projections on the derivatives are kept by Zᵀ.
        """
        matrices, record = self.matrices(beta), self.record
        x, output = simulated(matrices, record.input, record.phi, self.state(beta))
        of_model, n, rows = self.sizes.size, self.sizes.order, output.size
        columns = of_model + n + 1
        residual, jacobian = np.full(columns + 1, self.rounding), np.zeros((columns + 1, self.size))
        if not np.all(np.isfinite(output)) or abs(output).max() > 1e6 * abs(record.output).max():
            return np.full(columns + 1, np.inf), jacobian
        stacked = np.zeros((rows + n, columns))
        _fill_gradient(stacked[:rows, :of_model], matrices, record, x, self.root)
        stacked[:rows, of_model:-1] = _by_initial_state(matrices, record, self.root)
        stacked[:rows, -1] = solve_triangular(self.root, (record.output - output).T, lower=True).ravel()
        stacked[rows:, of_model:-1] = np.eye(n) / self.spread
        stacked[rows:, -1] = -self.state(beta) / self.spread
        factor: FloatArray = np.asarray(np.linalg.qr(stacked, mode="r"))
        residual[: len(factor)], residual[len(factor) : -1] = factor[:, -1], 0.0
        jacobian[: len(factor), : self.sizes.free] = -factor[:, :of_model] @ self.chart
        jacobian[: len(factor), self.sizes.free :] = -factor[:, of_model:-1]
        return residual, jacobian


def _by_initial_state(matrices: Matrices, record: Signals, root: FloatArray) -> FloatArray:
    """Σ_w^{-½} ∂ŷ/∂x(0), (n_y N, n_x), zero from where it has died out or blown up."""
    a, _, c, _ = along(matrices, record.phi)
    n = a.shape[1]
    with np.errstate(over="ignore", invalid="ignore"):
        states = propagate(a, np.zeros((n, len(a), n)), np.eye(n))[:, :-1]
        output = solve_triangular(root, np.eye(len(root)), lower=True) @ c @ states[..., None]
    found = np.where(abs(output[..., 0]) < LARGE, output[..., 0], 0.0)
    return np.asarray(found.transpose(2, 1, 0).reshape(-1, n))


def _fill_gradient(found: FloatArray, matrices: Matrices, record: Signals, x: FloatArray, root: FloatArray) -> None:
    """Σ_w^{-½} ∂ŷ/∂θ into `found` (n_y N, n_θ), from the sensitivities of the state to a pulse in each equation."""
    n_y, samples, n = record.output.shape[1], len(x), x.shape[1]
    a, _, c, _ = along(matrices, record.phi)
    drive = record.phi[:, :, None] * np.concatenate([x, record.input], axis=1)[:, None, :]
    whitener = solve_triangular(root, np.eye(n_y), lower=True)
    sensitivity = _sensitivities(a, drive.reshape(samples, -1)).reshape(samples, n, -1)
    # Axes: output, sample, basis function, equation, state or input.
    by_output = ((whitener @ c) @ sensitivity).reshape(samples, n_y, n, *drive.shape[1:])
    through = by_output.transpose(1, 0, 3, 2, 4)
    direct = whitener[:, None, None, :, None] * drive[:, :, None, :]
    parts = [part[..., cut] for part in (through, direct) for cut in (slice(n), slice(n, None))]
    place = 0
    for part, stack in zip(parts, matrices, strict=True):
        found[:, place : place + stack.size].reshape(n_y, samples, *stack.shape)[...] = part
        place += stack.size


def _sensitivities(A: FloatArray, drive: FloatArray) -> FloatArray:
    """S(t+1) = A(t) S(t) + I ⊗ φ(t), (N, n_x, n_x, m): state, equation, regressor."""
    n, n_x = len(A), A.shape[1]
    found = np.zeros((n, n_x, n_x, drive.shape[1]))
    flat = found.reshape(n, n_x, -1)
    equation = np.arange(n_x)
    for t in range(n - 1):
        np.matmul(A[t], flat[t], out=flat[t + 1])
        found[t + 1, equation, equation] += drive[t]
    return found
