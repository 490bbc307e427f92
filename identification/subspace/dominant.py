"""The dominant left singular vectors of a matrix with few rows and many columns, to full precision."""

import numpy as np

from identification.arrays import FloatArray

RESOLVED = 1e-11  # of the largest eigenvalue of X Xᵀ: smaller ones are found in another round
NEGLIGIBLE = 1e-36


def dominant_left_vectors(rows: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """U (R, r), r ≤ `count`, and all singular values (R,), of X (R, N) with R ≪ N.

        X Xᵀ ≈ V Λ Vᵀ,   Q = orth(Xᵀ V_r),   X Q = U Σ Wᵀ

    The eigenvectors of X Xᵀ that are well above the rounding error of squares choose a few columns; a Rayleigh–Ritz
    step on X itself makes these as accurate as a QR factorisation of Xᵀ would at a fraction of its work. What is
    smaller is found from X − X Q Qᵀ in another round, so that singular values count down to some 10⁻¹⁵ of the
    largest; below lie rounding errors, and r < `count` only where nothing at all is left.
    """
    parts: list[FloatArray] = []
    largest, found = 0.0, 0
    while True:
        values, vectors = np.linalg.eigh(rows @ rows.T)
        values, vectors = values[::-1], vectors[:, ::-1]
        largest = largest or max(float(values[0]), np.finfo(float).tiny)
        usable = values > max(RESOLVED * values[0], NEGLIGIBLE * largest)
        kept = min(count - found, int(np.sum(usable)))
        if kept:
            orthonormal = _row_space(rows, vectors[:, :kept], values[:kept])
            parts.append(rows @ orthonormal.T)
            found += kept
        if found == count or kept == 0:
            break
        rows = rows - parts[-1] @ orthonormal
    if not parts:
        return np.zeros((len(rows), 0)), np.zeros(len(rows))
    left, sizes, _ = np.linalg.svd(np.concatenate(parts, axis=1), full_matrices=False)
    rest = np.sqrt(np.maximum(values[kept : kept + len(rows) - found], 0.0))
    return left, np.concatenate([sizes, rest])


def _row_space(rows: FloatArray, vectors: FloatArray, values: FloatArray) -> FloatArray:
    """orth(Xᵀ V)ᵀ (r, N) for eigenvectors of X Xᵀ: nearly orthogonal rows, so that one Cholesky step does."""
    found = (vectors / np.sqrt(values)).T @ rows
    factor = np.linalg.cholesky(found @ found.T)
    return np.asarray(np.linalg.inv(factor) @ found)
