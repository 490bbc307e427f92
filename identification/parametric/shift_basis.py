"""Polynomials of z, or of jω, in which an extended observability matrix is well conditioned."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from identification.arrays import ComplexArray, FloatArray

Family = Literal["powers", "orthonormal"]


@dataclass(frozen=True, eq=False)
class ShiftBasis:
    """Polynomials φ₀ = 1, φ₁, …, φ_{q−1} of rising degree with real coefficients, and what z does to them.

        z φ_k(z) = Σ_{i ≤ k+1} H_{ik} φ_i(z),   k = 0 … q − 2,   H: q × (q − 1) upper Hessenberg

    With the powers φ_k = z^k, H is the shift of [Akcay2008, (J₁, J₂)]; for an observability matrix with block rows
    C φ_k(A) in their place the relation J₁O A = J₂O becomes J₁O A = (Hᵀ ⊗ I) O. Weighted by the covariance of the
    noise both families span the same subspace.
    """

    shift: FloatArray

    @property
    def size(self) -> int:
        """q."""
        return len(self.shift)

    def evaluate(self, z: ComplexArray) -> ComplexArray:
        """The polynomials at z (F,), as (q, F)."""
        values = np.ones((self.size, len(z)), dtype=np.complex128)
        for k in range(self.size - 1):
            rest = z * values[k] - self.shift[: k + 1, k] @ values[: k + 1]
            values[k + 1] = rest / self.shift[k + 1, k]
        return values


def shift_basis(z: ComplexArray, size: int, family: Family) -> ShiftBasis:
    """The first `size` powers, or the polynomials orthonormal over the points z (F,) and their conjugates.

    The latter by Arnoldi's process in the inner product Re(uᴴv)/F, orthogonalised twice. Needs more points than
    half of `size`.
    """
    shift = np.eye(size, size - 1, -1)
    if family == "powers":
        return ShiftBasis(shift)
    stacked = np.concatenate([z, z.conj()])
    values = np.ones((size, len(stacked)), dtype=np.complex128)
    for k in range(size - 1):
        rest = stacked * values[k]
        shift[:, k] = 0.0
        for _ in range(2):
            part = (values[: k + 1].conj() @ rest).real / len(stacked)
            shift[: k + 1, k] += part
            rest = rest - part @ values[: k + 1]
        shift[k + 1, k] = np.linalg.norm(rest) / np.sqrt(len(stacked))
        values[k + 1] = rest / shift[k + 1, k]
    return ShiftBasis(shift)
