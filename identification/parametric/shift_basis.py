"""Polynomials of z, or of jω, in which an extended observability matrix is well conditioned."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.subspace.polynomials import OrthonormalPolynomials, by_recursion

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
        return by_recursion(self.shift, z)


def shift_basis(z: ComplexArray, size: int, family: Family) -> ShiftBasis:
    """The first `size` powers, or the polynomials orthonormal over the points z (F,) and their conjugates.

    Raises NotIdentifiableError where the points cannot tell the latter apart.
    """
    if family == "powers":
        return ShiftBasis(np.eye(size, size - 1, -1))
    return ShiftBasis(OrthonormalPolynomials.on(z, size).shift[:, :-1])
