"""Directions of a measurement that no one asks for, such as transients, taken out of whitened rows."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray

SMALLEST = 1e-12


@dataclass(frozen=True, eq=False)
class Nuisance:
    """For M records the span of whitened columns W Φ (M, R, c), with Φ = `columns` (M, c, K) in lines.

        rows → rows − Q Qᵀ rows,   W Φ = Q Σ Vᵀ,   x = V Σ⁻¹ Qᵀ rows

    `basis` Qᵀ (M, r, R), rows of zeros where a record has fewer directions; `solving` V Σ⁻¹ (M, c, r).
    """

    columns: ComplexArray
    basis: FloatArray
    solving: FloatArray

    @classmethod
    def of(cls, columns: ComplexArray, whitened: FloatArray) -> "Nuisance":
        """From columns (M, c, K) and the same whitened, (M, c, R)."""
        first, once = _orthonormal(whitened)
        basis, twice = _orthonormal(first)
        return cls(columns, basis, np.swapaxes(twice @ once, 1, 2))

    @property
    def counts(self) -> FloatArray:
        """How many directions are taken from each record, (M,)."""
        return np.asarray(np.sum(self.basis**2, axis=(1, 2)))

    def taken_out(self, rows: FloatArray) -> FloatArray:
        """Rows (…, M, R) without these directions."""
        return np.asarray(rows - np.einsum("...mi,mir->...mr", self._onto(rows), self.basis, optimize=True))

    def fitted(self, rows: FloatArray) -> ComplexArray:
        """Φ x (M, K), the part of a measurement with whitened rows (M, R) that these directions explain."""
        coefficients = np.einsum("mci,mi->mc", self.solving, self._onto(rows))
        return np.asarray(np.einsum("mc,mck->mk", coefficients, self.columns))

    def _onto(self, rows: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("...mr,mir->...mi", rows, self.basis, optimize=True))


def _orthonormal(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Orthonormal combinations C rows (M, c, R) of rows (M, c, R), zero where there are fewer, and C (M, c, c)."""
    size = np.linalg.norm(rows, axis=-1, keepdims=True)
    scaled = rows / np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh(scaled @ np.swapaxes(scaled, 1, 2))
    kept = values > SMALLEST * values[:, -1:]
    inverse = np.where(kept, 1 / np.sqrt(np.where(kept, values, 1.0)), 0.0)
    mixing = np.swapaxes(vectors * inverse[:, None, :], 1, 2)
    return mixing @ scaled, mixing / np.where(size > 0, size, 1.0)[:, None, :, 0]
