"""B and D by weighted linear least squares, for given A and C."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError
from identification.models.resolvent import resolvent, resolvent_by_entry
from identification.subspace.compression import solve_compressed, triangle
from identification.subspace.noise import Noise

NUMBERS = 1 << 18  # treated at a time


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
    parts = [_weighted(a, c, z, response[..., j : j + 1], noise.weights[..., j]) for j in range(response.shape[2])]
    b, d = (np.concatenate(each, axis=1) for each in zip(*parts, strict=True))
    return b, d


def _weighted(
    a: FloatArray, c: FloatArray, z: ComplexArray, response: ComplexArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """One weight for each line and output (F, n_y).

    A row of D occurs in the equations of one output only, and is eliminated from them by their own triangle.
    """
    n, n_y = len(a), len(c)
    factors: list[FloatArray | None] = [None] * n_y
    step = max(NUMBERS // (n_y * (n + response.shape[2])), 64)
    for first in range(0, len(z), step):
        here = slice(first, first + step)
        columns = _columns(a, c, z[here], response[here], weights[here])
        factors = [triangle([x], factor) for x, factor in zip(columns, factors, strict=True)]
    found = np.array(factors)
    b, regular = solve_compressed(
        triangle([np.ascontiguousarray(found[:, 1:, 1:].reshape(-1, found.shape[2] - 1).T)]), n
    )
    if not regular:
        raise _not_determined(n)
    return b, (found[:, 0, 1 + n :] - found[:, 0, 1 : 1 + n] @ b) / found[:, 0, :1]


def _columns(a: FloatArray, c: FloatArray, z: ComplexArray, response: ComplexArray, weights: FloatArray) -> FloatArray:
    """Weighted [1, C (zI − A)⁻¹, Ĝ] of each output, real parts before imaginary ones, (n_y, 1 + n + n_u, 2F)."""
    states, w = resolvent_by_entry(a, np.eye(len(a)), c, z), weights.T
    n, count = len(a), len(z)
    columns = np.empty((len(c), 1 + n + response.shape[2], 2 * count))
    columns[:, 0, :count], columns[:, 0, count:] = w, 0.0
    answers = response.transpose(1, 2, 0)
    for part, here in ((np.real, slice(count)), (np.imag, slice(count, None))):
        np.multiply(part(states), w[:, None], out=columns[:, 1 : 1 + n, here])
        np.multiply(part(answers), w[:, None], out=columns[:, 1 + n :, here])
    return columns


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
