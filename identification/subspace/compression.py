"""Least squares with very many equations, compressed block by block."""

from collections.abc import Iterable

import numpy as np
from scipy.linalg import lapack

from identification.arrays import FloatArray

BLOCK = 1 << 17  # numbers factorised at a time


def triangle(columns: Iterable[FloatArray], factor: FloatArray | None = None) -> FloatArray:
    """R (C, C) with RᵀR = Σ X Xᵀ for pieces X (C, N) of the transposed equations, as a QR factorisation gives it.

    A `factor` found from earlier pieces may be continued.
    """
    for piece in columns:
        width = max(BLOCK // len(piece), 2 * len(piece))
        for first in range(0, piece.shape[1], width):
            block = piece[:, first : first + width]
            factor = _r(block if factor is None else np.concatenate([factor.T, block], axis=1))
    if factor is None:
        raise ValueError("there are no equations")
    return factor


def _r(transposed: FloatArray) -> FloatArray:
    """R (C, C) of the QR factorisation of Xᵀ for X (C, N), with rows of zeros where N < C."""
    count, width = transposed.shape
    if width < count:
        transposed = np.concatenate([transposed, np.zeros((count, count - width))], axis=1)
    reflected, *_ = lapack.dgeqrf(transposed.T, lwork=64 * count)
    return np.triu(reflected[:count])


def solve_compressed(factor: FloatArray, unknowns: int) -> tuple[FloatArray, bool]:
    """x (unknowns, r) of min ‖X x − Y‖ from R of [X Y], and whether X has full column rank.

    The columns are scaled to one length first, as the rank should not depend on units.
    """
    left, right = factor[:unknowns, :unknowns], factor[:unknowns, unknowns:]
    norms = np.linalg.norm(left, axis=0)
    scale = np.where(norms > 0, norms, 1.0)
    solution, _, rank, _ = np.linalg.lstsq(left / scale, right, rcond=1e-15 * max(unknowns, 1))
    return solution / scale[:, None], bool(rank == unknowns)
