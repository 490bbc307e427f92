"""Maximum likelihood of affine state-space models from time records with white output noise."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from scipy.linalg import solve_triangular

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError, RangeError, ShapeError
from identification.least_squares import levenberg_marquardt
from identification.models.recursion import propagate
from identification.outcome import Outcome
from identification.varying.affine_estimate import AffineEstimate
from identification.varying.affine_parameters import AffineSizes
from identification.varying.affine_state_space import AffineStateSpace, Matrices, frozen_matrices
from identification.varying.progress import Progress, Steps, silent, within
from identification.varying.records import VaryingRecord

ROUNDS = 4
LARGE = 1e100


@dataclass(frozen=True, eq=False, kw_only=True)
class OutputErrorEstimate(AffineEstimate):
    """With the covariance Σ_w (n_y, n_y) of the noise, the errors y − ŷ (N, n_y) and the first state (n_x,)."""

    noise_covariance: FloatArray
    errors: FloatArray
    initial_state: FloatArray


@dataclass(frozen=True)
class OutputError:
    """Maximum likelihood in the time domain from a model near it, for white noise and scheduling of any kind.

    See `output_error`.
    """

    kind: ClassVar[str] = "output_error"

    max_iterations: Annotated[int, "most iterations in each of four rounds, after which the noise is weighed anew"] = 30

    def __post_init__(self) -> None:
        if self.max_iterations < 1:
            raise RangeError(f"max_iterations is {self.max_iterations}; it must be one or more", "max_iterations")

    def estimate(
        self, record: VaryingRecord, order: int | None, start: AffineStateSpace, *, progress: Progress = silent
    ) -> OutputErrorEstimate:
        """The estimate of a record; the order is that of the start. Raises as `output_error`."""
        if order not in (None, start.order):
            raise ShapeError(f"the start has order {start.order}, {order} is asked for", "start")
        return output_error(start, record, self.max_iterations, progress)

    @classmethod
    def example(cls) -> "OutputError":
        """A small one, for the conformance tests."""
        return cls()


def output_error(
    start: AffineStateSpace, record: VaryingRecord, max_iterations: int = 30, progress: Progress = silent
) -> OutputErrorEstimate:
    """The output-error estimate from a model near it: maximum likelihood when the noise is white and Gaussian.

        θ̂, x̂(0) = arg min Σ_t ‖Σ_w^{-½} (y(t) − ŷ(t, θ, x(0)))‖²,   P_θ = Q (QᵀJᵀJQ)⁻¹ Qᵀ

    All matrices are free; θ moves in the orthogonal complement Q of what a change of state coordinates does to first
    order, A_kT − TA_k, −TB_k, C_kT, at the start of each round, so that JQ has full rank. Σ_w is the covariance of the
    errors of the round before, at least 1e-20 of the output's mean square. The record may begin in any state. Raises
    ShapeError for sizes that do not fit and NotIdentifiableError with fewer values of the output than parameters.
    """
    _require_fit(start, record)
    model, iterations, initial = start, 0, np.zeros(start.order)
    floor = 1e-20 * np.maximum(np.mean(record.output**2, axis=0), np.finfo(float).tiny)
    errors = record.output - _simulated(_matrices(model), record, initial)[1]
    for i in range(ROUNDS):
        steps = Steps(within(progress, i / ROUNDS, (i + 1) / ROUNDS), f"likelihood, round {i + 1}")
        problem = _Problem(model, initial, record, errors.T @ errors / len(errors) + np.diag(floor), floor)
        solution = levenberg_marquardt(steps.of(problem.evaluate), np.zeros(problem.size), None, max_iterations, 1e-4)
        iterations += solution.outcome.iterations
        a, b, c, d = problem.matrices(solution.x)
        model, initial = replace(model, a=a, b=b, c=c, d=d), problem.state(solution.x)
        errors = record.output - _simulated((a, b, c, d), record, initial)[1]
        if solution.outcome.status != "converged" or solution.cost > (1 - 1e-6) * errors.size:
            break
        if np.all(np.mean(errors**2, axis=0) < floor):
            break
    outcome = Outcome(solution.outcome.status, solution.outcome.advice, iterations)
    known = outcome.status != "not_identifiable"
    of_model = slice(0, problem.sizes.free)
    covariance = problem.chart @ solution.covariance[of_model, of_model] @ problem.chart.T if known else None
    noise = errors.T @ errors / len(errors)
    return OutputErrorEstimate(
        model, outcome, (), covariance, noise_covariance=noise, errors=errors, initial_state=initial
    )


def _require_fit(start: AffineStateSpace, record: VaryingRecord) -> None:
    widths = (start.n_inputs, start.n_outputs, start.n_scheduling)
    given = tuple(signal.shape[1] for signal in (record.input, record.output, record.scheduling))
    if widths != given:
        raise ShapeError(
            f"the model has {widths} inputs, outputs and scheduling signals, the record {given}; give the same",
            "record",
        )
    parameters = AffineSizes.of(start).size
    if record.output.size <= parameters:
        raise NotIdentifiableError(
            f"{record.output.size} values of the output cannot determine {parameters} parameters; record longer or"
            " choose a lower order",
            "output",
        )


def _matrices(model: AffineStateSpace) -> Matrices:
    return model.a, model.b, model.c, model.d


def _simulated(matrices: Matrices, record: VaryingRecord, initial: FloatArray) -> tuple[FloatArray, FloatArray]:
    """States (N, n_x) and output (N, n_y) from x(0); what diverges comes out as inf or nan."""
    a, b, c, d = frozen_matrices(matrices, record.scheduling)
    u = record.input[..., None]
    with np.errstate(over="ignore", invalid="ignore"):
        x = propagate(a, (b @ u)[..., 0], initial)[:-1]
        return x, np.asarray((c @ x[..., None] + d @ u)[..., 0])


class _Problem:
    """Whitened errors and their derivative with respect to (β, ξ), θ = θ_start + Q β, x(0) = `initial` + ξ.

    A thousand times the size of the states is the deviation of x(0) in advance: what nothing shows of it stays at zero.
    """

    def __init__(
        self,
        start: AffineStateSpace,
        initial: FloatArray,
        record: VaryingRecord,
        noise: FloatArray,
        floor: FloatArray,
    ) -> None:
        self.sizes, self.initial = AffineSizes.of(start), initial
        self.size = self.sizes.free + self.sizes.order
        states = _simulated(_matrices(start), record, np.zeros(start.order))[0]
        size = float(np.sqrt(np.mean(np.minimum(states**2, LARGE**2), where=np.isfinite(states))))
        self.spread = 1e3 * (size or 1.0)
        self.start = self.sizes.join(_matrices(start))
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
        x, output = _simulated(matrices, record, self.state(beta))
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


def _by_initial_state(matrices: Matrices, record: VaryingRecord, root: FloatArray) -> FloatArray:
    """Σ_w^{-½} ∂ŷ/∂x(0), (n_y N, n_x), zero from where it has died out or blown up."""
    a, _, c, _ = frozen_matrices(matrices, record.scheduling)
    n = a.shape[1]
    with np.errstate(over="ignore", invalid="ignore"):
        states = propagate(a, np.zeros((n, len(a), n)), np.eye(n))[:, :-1]
        output = solve_triangular(root, np.eye(len(root)), lower=True) @ c @ states[..., None]
    found = np.where(abs(output[..., 0]) < LARGE, output[..., 0], 0.0)
    return np.asarray(found.transpose(2, 1, 0).reshape(-1, n))


def _fill_gradient(
    found: FloatArray, matrices: Matrices, record: VaryingRecord, x: FloatArray, root: FloatArray
) -> None:
    """Σ_w^{-½} ∂ŷ/∂θ into `found` (n_y N, n_θ), from the sensitivities of the state to a pulse in each equation."""
    n_y, samples, n = record.output.shape[1], len(x), x.shape[1]
    a, _, c, _ = frozen_matrices(matrices, record.scheduling)
    psi = np.concatenate([np.ones((samples, 1)), record.scheduling], axis=1)
    drive = psi[:, :, None] * np.concatenate([x, record.input], axis=1)[:, None, :]
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
