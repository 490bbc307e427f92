"""The matrices of an affine state-space model as one vector θ, and the directions in which θ changes nothing."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.errors import RangeError
from identification.models.chart import perpendicular
from identification.models.model import Model
from identification.scheduling import SchedulingVariable
from identification.varying.affine_state_space import AffineStateSpace, Matrices


@dataclass(frozen=True)
class AffineSizes:
    """Sizes of an affine model; θ = (A_0, …, A_np, B_0, …, C_0, …, D_0, …), every matrix row by row."""

    order: int
    n_scheduling: int
    n_inputs: int
    n_outputs: int

    @classmethod
    def of(cls, model: AffineStateSpace) -> "AffineSizes":
        """Those of a model."""
        return cls(model.order, model.n_scheduling, model.n_inputs, model.n_outputs)

    @classmethod
    def like(cls, model: Model) -> "AffineSizes":
        """Those of a model over scheduling variables."""
        structure = model.structure
        return cls(structure.order, len(model.variables), structure.inputs, structure.outputs)

    @property
    def shapes(self) -> tuple[tuple[int, int, int], ...]:
        """Of the stacks a, b, c, d."""
        m, n, n_u, n_y = self.n_scheduling + 1, self.order, self.n_inputs, self.n_outputs
        return (m, n, n), (m, n, n_u), (m, n_y, n), (m, n_y, n_u)

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

    def model(
        self, theta: FloatArray, sample_time: float, variables: tuple[SchedulingVariable, ...] = ()
    ) -> AffineStateSpace:
        """The model of θ."""
        return AffineStateSpace(*self.split(theta), sample_time, variables)

    @property
    def in_products(self) -> IntArray:
        """Where in θ each entry stands when the functions 1, p_1, p_2, … stand as products do: the last p first."""
        functions = [0, *range(self.n_scheduling, 0, -1)]
        numbers = self.split(np.arange(self.size, dtype=np.float64))
        return np.concatenate([part[functions].ravel() for part in numbers]).astype(np.int64)

    def similarity_tangent(self, theta: FloatArray) -> FloatArray:
        """The directions (size, n_x²) of a change of the state basis x' = (I + εE)⁻¹ x [Goos2014, (10)].

        dA_i = A_i E − E A_i,   dB_i = −E B_i,   dC_i = C_i E,   dD_i = 0
        """
        a, b, c, d = self.split(theta)
        directions = []
        for unit in np.eye(self.order**2).reshape(-1, self.order, self.order):
            directions.append(self.join((a @ unit - unit @ a, -unit @ b, c @ unit, np.zeros_like(d))))
        return np.stack(directions, axis=1)

    def chart(self, theta: FloatArray) -> FloatArray:
        """An orthonormal basis Q (size, free) of what is perpendicular to the changes of the state basis at θ."""
        return perpendicular(self.similarity_tangent(theta))


def stated_order(order: int | None) -> int:
    """The order n_x; raises RangeError when it is not stated or not positive."""
    if order is None or order < 1:
        raise RangeError(f"the order is {order}; state a number of states, one or more", "order")
    return order


def balanced(model: AffineStateSpace) -> AffineStateSpace:
    """The model in a basis where Σ_i B_i B_iᵀ driven through A_0 and its dual for C_i are equal and diagonal.

    Only a scaling that keeps numbers alike: A_0 is shrunk where it is not stable by itself, and a model with states
    that nothing drives or nobody sees is left as it is.
    """
    a = model.a[0]
    a = a * min(1.0, 0.98 / max(float(abs(np.linalg.eigvals(a)).max(initial=0.0)), 1e-12))
    reach = _gramian(a, sum(part @ part.T for part in model.b))
    observe = _gramian(a.T, sum(part.T @ part for part in model.c))
    try:
        left, right = np.linalg.cholesky(reach), np.linalg.cholesky(observe)
    except np.linalg.LinAlgError:
        return model
    _, values, v = np.linalg.svd(right.T @ left)
    if values[-1] <= 1e-10 * values[0]:
        return model
    return model.transformed(np.asarray(left @ v.T / np.sqrt(values)))


def _gramian(a: FloatArray, drive: FloatArray) -> FloatArray:
    n = len(a)
    solved = np.linalg.solve(np.eye(n * n) - np.kron(a, a), drive.ravel()).reshape(n, n)
    return np.asarray((solved + solved.T) / 2)
