"""B and D by weighted linear least squares, for given A and C."""

from collections.abc import Iterator

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError
from identification.resolvent import resolvent
from identification.subspace.compression import solve_compressed, triangle
from identification.subspace.noise import Noise

LINES = 1 << 16  # treated at a time


def input_matrices(
    a: FloatArray, c: FloatArray, z: ComplexArray, response: ComplexArray, noise: Noise
) -> tuple[FloatArray, FloatArray]:
    """B (n, n_u) and D (n_y, n_u) for z (F,) and Ĝ (F, n_y, n_u).

        min Σ_k ‖R_k^{−1/2} (Ĝ_k − D − C (z_k I − A)⁻¹ B)‖_F²                             [Akcay2008, Algorithm 2, 6]

    One compressed problem for all inputs where the noise is alike in them, one an input where it is not, and one
    whitened problem in all unknowns where the entries of the response are correlated.
    Raises NotIdentifiableError where the lines do not determine B and D.
    """
    if noise.covariance is not None:
        return _correlated(a, c, z, response, noise)
    if noise.same_for_inputs:
        return _weighted(a, c, z, response, noise.weights[..., 0])
    parts = [
        _weighted(a, c, z, response[..., j : j + 1], noise.weights[..., j]) for j in range(response.shape[2])
    ]
    b, d = (np.concatenate(each, axis=1) for each in zip(*parts, strict=True))
    return b, d


def _weighted(
    a: FloatArray, c: FloatArray, z: ComplexArray, response: ComplexArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """One weight for each line and output (F, n_y): D is eliminated, as it is a weighted mean of what B leaves."""
    n, total = len(a), np.sum(weights**2, axis=0)
    columns = _Columns(a, c, z, response, weights)
    mean = sum((np.einsum("cka,ka->ac", x.real, w) for x, w in columns), np.zeros((len(c), n + response.shape[2])))
    mean = mean / total[:, None]
    pieces = (_real(x - w * mean.T[:, None, :]) for x, w in columns)
    b, regular = solve_compressed(triangle(pieces), n)
    if not regular:
        raise _not_determined(n)
    return b, mean[:, n:] - mean[:, :n] @ b


class _Columns:
    """Weighted C (zI − A)⁻¹ and Ĝ, unknowns first, as (n + n_u, F', n_y), with their weights, block by block."""

    def __init__(
        self, a: FloatArray, c: FloatArray, z: ComplexArray, response: ComplexArray, weights: FloatArray
    ) -> None:
        self.a, self.c, self.z, self.response, self.weights = a, c, z, response, weights

    def __iter__(self) -> Iterator[tuple[ComplexArray, FloatArray]]:
        for first in range(0, len(self.z), LINES):
            here = slice(first, first + LINES)
            states = resolvent(self.a, np.eye(len(self.a)), self.c, self.z[here])
            both = np.concatenate([states, self.response[here]], axis=2) * self.weights[here, :, None]
            yield np.ascontiguousarray(np.moveaxis(both, 2, 0)), self.weights[here]


def _correlated(
    a: FloatArray, c: FloatArray, z: ComplexArray, response: ComplexArray, noise: Noise
) -> tuple[FloatArray, FloatArray]:
    count, n_y, n_u = response.shape
    states = resolvent(a, np.eye(len(a)), c, z)
    outputs = np.concatenate([states, np.broadcast_to(np.eye(n_y), (count, n_y, n_y))], axis=2)
    unknowns = (len(a) + n_y) * n_u
    every = np.einsum("kas,ij->kaisj", outputs, np.eye(n_u)).reshape(count, n_y * n_u, unknowns)
    both = noise.whiten(np.concatenate([every, response.reshape(count, -1, 1)], axis=2))
    solution, regular = solve_compressed(triangle([_real(np.ascontiguousarray(np.moveaxis(both, 2, 0)))]), unknowns)
    if not regular:
        raise _not_determined(len(a))
    b, d = np.split(solution.reshape(-1, n_u), [len(a)])
    return b, d


def _real(columns: ComplexArray) -> FloatArray:
    """Real and imaginary parts as equations of their own, (C, 2N)."""
    return columns.reshape(len(columns), -1).view(np.float64)


def _not_determined(order: int) -> NotIdentifiableError:
    return NotIdentifiableError(
        f"the lines do not determine B and D of order {order}; measure more frequencies or choose a lower order",
        "order",
    )
