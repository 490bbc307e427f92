"""State-space models with several inputs and outputs: frequency response, poles and simulation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import schur

from identification.arrays import BoolArray, ComplexArray, FloatArray, finite_floats, require_positive
from identification.errors import MisuseError, ShapeError
from identification.models.resolvent import resolvent


class MatrixSizes:
    """n, n_u and n_y of state-space matrices: a (…, n, n), b (…, n, n_u), c (…, n_y, n)."""

    a: FloatArray
    b: FloatArray
    c: FloatArray

    @property
    def order(self) -> int:
        """n."""
        return int(self.a.shape[-1])

    @property
    def input_count(self) -> int:
        """n_u."""
        return int(self.b.shape[-1])

    @property
    def output_count(self) -> int:
        """n_y."""
        return int(self.c.shape[-2])


@dataclass(frozen=True, eq=False)
class StateSpace(MatrixSizes):
    """A linear time-invariant system of order n with n_u inputs and n_y outputs, or an array (…) of them.

        ẋ or x(t + T) = A x + B u,   y = C x + D u,   G = D + C (zI − A)⁻¹ B            [Akcay2008, Problem Formulation]

    `a` (…, n, n), `b` (…, n, n_u), `c` (…, n_y, n), `d` (…, n_y, n_u); `sample_time` T in seconds with z = e^{jωT},
    None for continuous time with jω in place of z. Raises ShapeError for sizes that do not fit and RangeError for
    values that are not finite or a sample time ≤ 0.
    """

    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray
    sample_time: float | None = None

    def __post_init__(self) -> None:
        for name in "abcd":
            object.__setattr__(self, name, finite_floats(getattr(self, name), name))
        require_matching(self.a, self.b, self.c, self.d)
        if self.sample_time is not None:
            require_positive(self.sample_time, "sample time")

    def variable(self, omega: ArrayLike) -> ComplexArray:
        """z = e^{jωT}, or jω in continuous time, at ω (F,) in rad/s."""
        s = 1j * np.asarray(omega, dtype=np.float64)
        return np.asarray(s if self.sample_time is None else np.exp(s * self.sample_time))

    def frequency_response(self, omega: ArrayLike) -> ComplexArray:
        """G at ω (F,) in rad/s, as (…, F, n_y, n_u); raises RangeError where ω hits a pole."""
        return self.d[..., None, :, :] + resolvent(self.a, self.b, self.c, self.variable(omega))

    def states(self, omega: ArrayLike) -> ComplexArray:
        """(zI − A)⁻¹ B at ω (F,) in rad/s, as (…, F, n, n_u)."""
        return resolvent(self.a, self.b, np.eye(self.order), self.variable(omega))

    def adjoint_states(self, omega: ArrayLike) -> ComplexArray:
        """C (zI − A)⁻¹ at ω (F,) in rad/s, as (…, F, n_y, n)."""
        return resolvent(self.a, np.eye(self.order), self.c, self.variable(omega))

    @property
    def poles(self) -> ComplexArray:
        """The eigenvalues of A, (…, n): in the z-plane, or in rad/s in continuous time."""
        return np.asarray(np.linalg.eigvals(self.a), dtype=np.complex128)

    @property
    def stable(self) -> BoolArray:
        """Whether all poles are inside the unit circle, or the left half-plane in continuous time, as (…,)."""
        inside = self.poles.real < 0 if self.sample_time is None else abs(self.poles) < 1
        return np.asarray(np.all(inside, axis=-1))

    def simulate(self, input: ArrayLike, initial_state: ArrayLike | None = None) -> FloatArray:
        """y (N, n_y) for u (N, n_u) from the state x(0) (n,), zero by default; one discrete-time system.

        Solved state by state in Schur form. Raises MisuseError in continuous time or for an array of systems.
        """
        u = finite_floats(input, "input")
        x0 = np.zeros(self.order) if initial_state is None else finite_floats(initial_state, "initial_state")
        if self.sample_time is None or self.a.ndim != 2:
            raise MisuseError("only one system in discrete time can be simulated; sample it first", "sample_time")
        if u.ndim != 2 or u.shape[1] != self.input_count or x0.shape != (self.order,):
            raise ShapeError(
                f"the input has shape {u.shape} and the initial state {x0.shape}; give (N, {self.input_count}) and"
                f" ({self.order},)",
                "input",
            )
        triangle, basis = schur(self.a, output="complex")
        drive, start = u @ (basis.conj().T @ self.b).T, basis.conj().T @ x0
        w = np.zeros((len(u), self.order), dtype=np.complex128)
        for i in reversed(range(self.order)):
            total = drive[:, i] + w[:, i + 1 :] @ triangle[i, i + 1 :]
            w[:, i] = _first_order(triangle[i, i], total, start[i])
        return np.asarray((w @ (self.c @ basis).T).real + u @ self.d.T)

    def transformed(self, basis: FloatArray) -> "StateSpace":
        """The same system in the state T⁻¹ x for T (…, n, n)."""
        solved = np.linalg.solve(basis, np.concatenate([self.a @ basis, self.b], axis=-1))
        n = self.order
        return StateSpace(solved[..., :n], solved[..., n:], self.c @ basis, self.d, self.sample_time)


def _first_order(pole: complex, drive: ComplexArray, start: complex) -> ComplexArray:
    """w(t + 1) = λ w(t) + v(t) from w(0); loads scipy.signal with its first call only."""
    from scipy.signal import lfilter

    shifted = np.concatenate([[start], drive[:-1]])
    return np.asarray(lfilter(np.ones(1), np.array([1.0, -pole]), shifted))


def require_matching(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> None:
    """Raises ShapeError unless (…, n, n), (…, n, n_u), (…, n_y, n) and (…, n_y, n_u) fit each other."""
    shapes = [m.shape for m in (a, b, c, d)]
    if min(len(shape) for shape in shapes) >= 2 and len({shape[:-2] for shape in shapes}) == 1:
        n, n_u, n_y = a.shape[-1], b.shape[-1], c.shape[-2]
        if [shape[-2:] for shape in shapes] == [(n, n), (n, n_u), (n_y, n), (n_y, n_u)] and n_u and n_y:
            return
    raise ShapeError(
        f"A, B, C, D have shapes {', '.join(map(str, shapes))}; give (n, n), (n, n_u), (n_y, n), (n_y, n_u)",
        "a",
    )
