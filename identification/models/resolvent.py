"""C (zI − A)⁻¹ B at many z at once."""

import numpy as np
from scipy.linalg import schur

from identification.arrays import ComplexArray, FloatArray
from identification.errors import RangeError

WELL_CONDITIONED = 1e5
BLOCK = 1 << 20  # complex numbers held at a time


def resolvent(a: FloatArray, b: FloatArray, c: FloatArray, z: ComplexArray) -> ComplexArray:
    """C (zI − A)⁻¹ B for z (F,), as (…, F, n_y, n_u); see `resolvent_by_entry`."""
    return np.ascontiguousarray(np.moveaxis(resolvent_by_entry(a, b, c, z), -1, -3))


def resolvent_by_entry(a: FloatArray, b: FloatArray, c: FloatArray, z: ComplexArray) -> ComplexArray:
    """C (zI − A)⁻¹ B for z (F,), as (…, n_y, n_u, F).

    By partial fractions where the eigenvectors are well conditioned, all lines in one matrix product, and by back
    substitution in Schur form otherwise. `b` and `c` may lack the leading axes of `a` (…, n, n).
    Raises RangeError where a z is an eigenvalue of A.
    """
    n, batch = a.shape[-1], a.shape[:-2]
    result = np.zeros((*batch, c.shape[-2], b.shape[-1], len(z)), dtype=np.complex128)
    if n == 0:
        return result
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for index in np.ndindex(batch):
            result[index] = _one(a[index], b[index] if b.ndim > 2 else b, c[index] if c.ndim > 2 else c, z)
    if not np.all(np.isfinite(result)):
        raise RangeError("a frequency is that of a pole on the border of stability; leave it out", "frequencies")
    return result


def _one(a: FloatArray, b: FloatArray, c: FloatArray, z: ComplexArray) -> ComplexArray:
    poles, vectors = np.linalg.eig(a)
    result = np.empty((c.shape[0] * b.shape[1], len(z)), dtype=np.complex128)
    modal = np.linalg.cond(vectors) < WELL_CONDITIONED
    if modal:
        left, right = c @ vectors, np.linalg.solve(vectors, b.astype(np.complex128))
        residues = (left[:, None, :] * right.T[None]).reshape(-1, len(a))
    else:
        triangle, basis = schur(a, output="complex")
    step = max(BLOCK // (len(a) * (1 if modal else b.shape[1])), 1)
    for first in range(0, len(z), step):
        block = z[first : first + step]
        if modal:
            result[:, first : first + step] = residues @ (1 / (block - poles[:, None]))
        else:
            result[:, first : first + step] = _substituted(triangle, basis.conj().T @ b, c @ basis, block)
    return result.reshape(c.shape[0], b.shape[1], len(z))


def _substituted(triangle: ComplexArray, b: ComplexArray, c: ComplexArray, z: ComplexArray) -> ComplexArray:
    """C (zI − R)⁻¹ B for an upper triangular R, state by state for all lines, as (n_y n_u, F)."""
    n, n_u = b.shape
    x = np.empty((n, n_u * len(z)), dtype=np.complex128)
    for i in reversed(range(n)):
        right = triangle[i, i + 1 :] @ x[i + 1 :]
        x[i] = ((b[i][:, None] + right.reshape(n_u, -1)) / (z - triangle[i, i])).ravel()
    return np.asarray((c @ x).reshape(len(c) * n_u, -1))
