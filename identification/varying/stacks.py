"""Stacks of matrices, one a function of the scheduling, as one vector θ; what they are along signals."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError
from identification.models.chart import perpendicular
from identification.models.recursion import propagate
from identification.models.state_space import Matrices, StateSpaceStructure


@dataclass(frozen=True)
class StackSizes:
    """Sizes of matrices over k functions; θ = (A_1, …, A_k, B_1, …, C_1, …, D_1, …), every matrix row by row."""

    order: int
    functions: int
    n_inputs: int
    n_outputs: int

    @classmethod
    def of(cls, matrices: Matrices) -> "StackSizes":
        """Those of stacks (k, ·, ·)."""
        a, b, c, _ = matrices
        return cls(a.shape[1], len(a), b.shape[2], c.shape[1])

    @property
    def shapes(self) -> tuple[tuple[int, int, int], ...]:
        """Of the stacks a, b, c, d."""
        k, n, n_u, n_y = self.functions, self.order, self.n_inputs, self.n_outputs
        return (k, n, n), (k, n, n_u), (k, n_y, n), (k, n_y, n_u)

    @property
    def size(self) -> int:
        """Number of entries of θ."""
        return sum(int(np.prod(shape)) for shape in self.shapes)

    @property
    def free(self) -> int:
        """Number of parameters that the response depends on: the state basis takes n_x² away."""
        return self.size - self.order**2

    def split(self, theta: FloatArray) -> Matrices:
        """The stacks a, b, c, d of θ (..., size)."""
        ends = np.cumsum([int(np.prod(shape)) for shape in self.shapes])[:-1]
        parts = np.split(theta, ends, axis=-1)
        a, b, c, d = (part.reshape(*theta.shape[:-1], *s) for part, s in zip(parts, self.shapes, strict=True))
        return a, b, c, d

    def join(self, matrices: Matrices) -> FloatArray:
        """θ of the stacks."""
        return np.concatenate([np.asarray(part, dtype=np.float64).ravel() for part in matrices])

    def similarity_tangent(self, theta: FloatArray) -> FloatArray:
        """The directions (size, n_x²) of a change of the state basis, function by function [Goos2014, (10)]."""
        structure = StateSpaceStructure(self.order, self.n_inputs, self.n_outputs)
        each = np.concatenate([part.reshape(self.functions, -1) for part in self.split(theta)], axis=1)
        changes = np.split(structure.gauge(each), np.cumsum([r * c for r, c in structure.shapes])[:-1], axis=1)
        return np.concatenate([part.reshape(-1, part.shape[-1]) for part in changes])

    def chart(self, theta: FloatArray) -> FloatArray:
        """An orthonormal basis Q (size, free) of what is perpendicular to the changes of the state basis at θ."""
        return perpendicular(self.similarity_tangent(theta))


def stated_order(order: int | None) -> int:
    """The order n_x; raises RangeError when it is not stated or not positive."""
    if order is None or order < 1:
        raise RangeError(f"the order is {order}; state a number of states, one or more", "order")
    return order


def along(matrices: Matrices, signals: FloatArray) -> Matrices:
    """A(t) = Σ_i φ_i(t) A_i, … along φ (..., k) for stacks (..., k, ·, ·)."""

    def one(stack: FloatArray) -> FloatArray:
        flat = signals @ stack.reshape(*stack.shape[:-2], stack.shape[-2] * stack.shape[-1])
        return np.asarray(flat.reshape(*flat.shape[:-1], *stack.shape[-2:]))

    a, b, c, d = matrices
    return one(a), one(b), one(c), one(d)


def simulated(
    matrices: Matrices, u: FloatArray, signals: FloatArray, initial: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """States (..., N, n_x) and output (..., N, n_y) from x(0), of many models at once; what diverges is inf or nan."""
    a, b, c, d = along(matrices, signals)
    start = np.zeros(a.shape[-1]) if initial is None else initial
    with np.errstate(over="ignore", invalid="ignore"):
        x = propagate(a, (b @ u[..., None])[..., 0], start)[..., :-1, :]
        return x, np.asarray((c @ x[..., None] + d @ u[..., None])[..., 0])


def transformed(matrices: Matrices, basis: FloatArray) -> Matrices:
    """The same input–output behaviour with the state x' = T⁻¹ x, T (n_x, n_x) = `basis`."""
    a, b, c, d = matrices
    inverse = np.linalg.inv(basis).astype(np.float64)
    return inverse @ a @ basis, inverse @ b, c @ basis, d


def balanced(matrices: Matrices) -> Matrices:
    """The stacks in the state basis of `balancing`."""
    return transformed(matrices, balancing(matrices))


def balancing(matrices: Matrices) -> FloatArray:
    """The change of state basis T (n_x, n_x), x = T x', after which controllability and observability are alike.

    Σ_i B_i B_iᵀ driven through A_0 and its dual for C_i are then equal and diagonal: only a scaling that keeps numbers
    alike. A_0, that of the constant function, is shrunk where it is not stable by itself, and a model with states that
    nothing drives or nobody sees is left as it is.
    """
    a, b, c, _ = matrices
    same = np.eye(a.shape[-1])
    first = a[0] * min(1.0, 0.98 / max(float(abs(np.linalg.eigvals(a[0])).max(initial=0.0)), 1e-12))
    reach = _gramian(first, sum(part @ part.T for part in b))
    observe = _gramian(first.T, sum(part.T @ part for part in c))
    try:
        left, right = np.linalg.cholesky(reach), np.linalg.cholesky(observe)
    except np.linalg.LinAlgError:
        return same
    _, values, v = np.linalg.svd(right.T @ left)
    if values[-1] <= 1e-10 * values[0]:
        return same
    return np.asarray(left @ v.T / np.sqrt(values))


def _gramian(a: FloatArray, drive: FloatArray) -> FloatArray:
    n = len(a)
    solved = np.linalg.solve(np.eye(n * n) - np.kron(a, a), drive.ravel()).reshape(n, n)
    return np.asarray((solved + solved.T) / 2)
