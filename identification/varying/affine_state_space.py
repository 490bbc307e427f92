"""State-space models that depend affinely on the scheduling, simulated along p(t)."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import ComplexArray, FloatArray, finite_floats, require_positive
from identification.errors import RangeError, ShapeError
from identification.models.recursion import propagate
from identification.scheduling import SchedulingVariable
from identification.varying.records import require_within_range


@dataclass(frozen=True, eq=False)
class AffineStateSpace:
    """A discrete-time model whose matrices are affine in the scheduling p(t) [Goos2014, (1)–(3); Cox2018, (1)].

        x(t+1) = A(p(t)) x(t) + B(p(t)) u(t),   y(t) = C(p(t)) x(t) + D(p(t)) u(t),   A(p) = A_0 + Σ_i A_i p_i, …

    `a` (1 + n_p, n_x, n_x), `b` (1 + n_p, n_x, n_u), `c` (1 + n_p, n_y, n_x), `d` (1 + n_p, n_y, n_u), the constant
    matrices first; `sample_time` in seconds; `variables`: the n_p scheduling variables with their ranges, or none.
    Raises ShapeError for sizes that do not fit and RangeError for values that are not finite.
    """

    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray
    sample_time: float
    variables: tuple[SchedulingVariable, ...] = ()

    def __post_init__(self) -> None:
        for name in ("a", "b", "c", "d"):
            object.__setattr__(self, name, finite_floats(getattr(self, name), name))
            if getattr(self, name).ndim != 3:
                raise ShapeError(f"{name} has shape {getattr(self, name).shape}; stack 1 + n_p matrices", name)
        m, n = self.a.shape[:2]
        n_y, n_u = self.c.shape[1], self.b.shape[2]
        for name, shape in {"a": (m, n, n), "b": (m, n, n_u), "c": (m, n_y, n), "d": (m, n_y, n_u)}.items():
            if getattr(self, name).shape != shape:
                raise ShapeError(f"{name} has shape {getattr(self, name).shape}, {shape} is needed", name)
        if self.variables and len(self.variables) != m - 1:
            raise ShapeError(f"{len(self.variables)} scheduling variables and {m - 1} varying matrices", "variables")
        require_positive(self.sample_time, "sample time")

    @property
    def order(self) -> int:
        """n_x."""
        return int(self.a.shape[1])

    @property
    def n_scheduling(self) -> int:
        """n_p, the constant not counted."""
        return len(self.a) - 1

    @property
    def n_inputs(self) -> int:
        """n_u."""
        return int(self.b.shape[2])

    @property
    def n_outputs(self) -> int:
        """n_y."""
        return int(self.c.shape[1])

    def eigenvalues(self) -> ComplexArray:
        """Those of each A_i, (1 + n_p, n_x): they do not depend on the state basis [Goos2014, Section 5]."""
        return np.asarray(np.linalg.eigvals(self.a), dtype=np.complex128)

    def transformed(self, basis: FloatArray) -> "AffineStateSpace":
        """The same input–output behaviour with the state x' = T⁻¹ x, T (n_x, n_x) = `basis`."""
        inverse = np.linalg.inv(np.asarray(basis, dtype=np.float64)).astype(np.float64)
        return replace(self, a=inverse @ self.a @ basis, b=inverse @ self.b, c=self.c @ basis)

    def frozen(self, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """A, B, C, D at points or along p(t), (..., n_p): each (..., rows, columns). Raises ShapeError, RangeError."""
        return frozen_matrices((self.a, self.b, self.c, self.d), self._checked(points))

    def frequency_response(self, points: FloatArray, omega: FloatArray) -> ComplexArray:
        """C (zI − A)⁻¹ B + D at points (M, n_p) held still, ω (F,) in rad/s: (M, F, n_y, n_u)."""
        a, b, c, d = (part[:, None] for part in self.frozen(np.atleast_2d(points)))
        z = np.exp(1j * np.asarray(omega) * self.sample_time)[:, None, None]
        return np.asarray(c @ np.linalg.solve(z * np.eye(self.order) - a, b.astype(complex)) + d)

    def simulate(
        self,
        input: FloatArray,
        scheduling: FloatArray,
        initial_state: FloatArray | None = None,
        state_noise: FloatArray | None = None,
    ) -> FloatArray:
        """y (..., N, n_y) for u (..., N, n_u) along p (..., N, n_p), leading axes being runs.

        `initial_state` (..., n_x), zero when not given; `state_noise` w (..., N, n_x) is added to x(t + 1). Raises
        ShapeError, and RangeError for scheduling outside its range or an output that grows beyond all numbers.
        """
        u, p = np.asarray(input, dtype=np.float64), np.asarray(scheduling, dtype=np.float64)
        if u.ndim < 2 or p.ndim < 2 or u.shape[-1] != self.n_inputs or u.shape[-2] != p.shape[-2]:
            raise ShapeError(
                f"input has shape {u.shape} and scheduling {p.shape}; give (samples, {self.n_inputs}) and"
                f" (samples, {self.n_scheduling})",
                "input",
            )
        matrices = (self.a, self.b, self.c, self.d)
        output = simulate_matrices(matrices, u, self._checked(p), initial_state, state_noise)
        if not np.all(np.isfinite(output)):
            raise RangeError("the simulated output grows beyond all numbers: the model is unstable along p(t)", "model")
        return output

    def _checked(self, points: FloatArray) -> FloatArray:
        p = np.asarray(points, dtype=np.float64)
        if p.shape[-1] != self.n_scheduling:
            raise ShapeError(f"scheduling has {p.shape[-1]} signals, {self.n_scheduling} are needed", "scheduling")
        require_within_range(self.variables, p)
        return p


Matrices = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


def frozen_matrices(matrices: Matrices, p: FloatArray) -> Matrices:
    """A(p), B(p), C(p), D(p) (..., N, ·, ·) of stacks (..., 1 + n_p, ·, ·) along p (..., N, n_p), axes broadcast."""
    weights = np.concatenate([np.ones((*p.shape[:-1], 1)), p], axis=-1)

    def along(stack: FloatArray) -> FloatArray:
        flat = weights @ stack.reshape(*stack.shape[:-2], stack.shape[-2] * stack.shape[-1])
        return np.asarray(flat.reshape(*flat.shape[:-1], *stack.shape[-2:]))

    a, b, c, d = matrices
    return along(a), along(b), along(c), along(d)


def simulate_matrices(
    matrices: Matrices,
    u: FloatArray,
    p: FloatArray,
    initial_state: FloatArray | None = None,
    state_noise: FloatArray | None = None,
) -> FloatArray:
    """y (..., N, n_y) of many models at once, stacks (..., 1 + n_p, ·, ·); what diverges comes out as inf or nan."""
    a, b, c, d = frozen_matrices(matrices, p)
    forcing = (b @ u[..., None])[..., 0]
    if state_noise is not None:
        forcing = forcing + state_noise
    start = np.zeros(forcing.shape[-1]) if initial_state is None else initial_state
    with np.errstate(over="ignore", invalid="ignore"):
        x = propagate(a, forcing, start)[..., :-1, :]
        return np.asarray((c @ x[..., None] + d @ u[..., None])[..., 0])


def best_fit_rate(output: FloatArray, simulated: FloatArray) -> float:
    """How well ŷ (N, n_y) meets y (N, n_y), in % [Cox2018, (24)].

    BFR = 100 max{1 − Σ_t ‖y(t) − ŷ(t)‖ / Σ_t ‖y(t) − ȳ‖, 0}
    """
    _same_shape(output, simulated)
    errors = np.linalg.norm(output - simulated, axis=-1).sum()
    total = np.linalg.norm(output - output.mean(axis=0), axis=-1).sum()
    return _percent(float(errors), float(total))


def variance_accounted_for(output: FloatArray, simulated: FloatArray) -> float:
    """How much of the variance of y (N, n_y) is explained by ŷ (N, n_y), in % [Goos2014, (30); Cox2018, (25)].

    VAF = 100 max{1 − Σ_t ‖y(t) − ŷ(t) − ē‖² / Σ_t ‖y(t) − ȳ‖², 0},   ē the mean of y − ŷ
    """
    _same_shape(output, simulated)
    error = output - simulated
    return _percent(
        float(np.sum((error - error.mean(axis=0)) ** 2)), float(np.sum((output - output.mean(axis=0)) ** 2))
    )


def _same_shape(output: FloatArray, simulated: FloatArray) -> None:
    if output.ndim != 2 or output.shape != simulated.shape:
        raise ShapeError(
            f"output has shape {output.shape}, simulation {simulated.shape}; give (N, n_y) twice", "output"
        )


def _percent(error: float, total: float) -> float:
    if not total > 0:
        raise RangeError("the output is constant: no part of its variation can be explained", "output")
    if not np.isfinite(error):
        raise RangeError("the simulation holds values that are not finite", "simulated")
    return 100 * max(1 - error / total, 0.0)
