"""Polynomials in z that are orthonormal on the measured lines."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError


@dataclass(frozen=True, eq=False)
class OrthonormalPolynomials:
    """φ_0 … φ_{q−1} with real coefficients and deg φ_i = i, orthonormal on the lines z_k, k = 1 … F.

        1/F Σ_k Re φ_i(z_k)* φ_j(z_k) = δ_ij,   φ_0 = 1,   z φ_i = Σ_{j ≤ i+1} h_ji φ_j

    They span the rows z^i of the block Vandermonde matrix [Akcay2008, Algorithm 2] and take their place, because the
    powers themselves are nearly dependent where the lines lie close together. Built by Arnoldi's recursion, with a
    second orthogonalisation where the first one takes away more than it leaves. `values` (q, F); `shift`: the h_ji as
    (q, q), the part of z φ_{q−1} beyond φ_{q−1} left out; ‖shift‖ ≤ 1 on |z| = 1, which preserves the norm.
    """

    values: ComplexArray
    shift: FloatArray

    @classmethod
    def on(cls, z: ComplexArray, count: int) -> Self:
        """The first `count` of them on z (F,); raises NotIdentifiableError where the lines cannot tell them apart."""
        values = np.empty((count, len(z)), dtype=np.complex128)
        shift = np.zeros((count, count))
        values[0] = 1.0
        for i in range(count):
            following = z * values[i]
            shift[: i + 1, i], norm = _orthogonalise(following, values[: i + 1])
            if i + 1 < count:
                if norm <= 1e-13 * np.linalg.norm(shift[: i + 1, i]):
                    raise NotIdentifiableError(
                        f"the lines determine polynomials up to degree {i} only; measure more or better separated"
                        " frequencies or use fewer block rows",
                        "frequencies",
                    )
                shift[i + 1, i] = norm
                np.divide(following, norm, out=values[i + 1])
        return cls(values, shift)

    def elsewhere(self, z: ComplexArray) -> ComplexArray:
        """The same polynomials on other lines z (F',), by their recursion, as (q, F')."""
        return by_recursion(self.shift, z)


def by_recursion(shift: FloatArray, z: ComplexArray) -> ComplexArray:
    """Polynomials with φ_0 = 1 and z φ_i = Σ_{j ≤ i+1} h_ji φ_j at z (F,), as (q, F), for h (q, q − 1) or more."""
    values = np.empty((len(shift), len(z)), dtype=np.complex128)
    values[0] = 1.0
    for i in range(len(shift) - 1):
        following = z * values[i] - shift[: i + 1, i] @ values[: i + 1]
        np.divide(following, shift[i + 1, i], out=values[i + 1])
    return values


def _orthogonalise(vector: ComplexArray, basis: ComplexArray) -> tuple[FloatArray, float]:
    """Takes the projection of a vector (F,) on an orthonormal basis (i, F) away in place.

    Gives its coefficients (i,) and the root mean square of what is left.
    """
    real_vector, real_basis = vector.view(np.float64), basis.view(np.float64)
    total = real_basis @ real_vector / len(vector)
    real_vector -= total @ real_basis
    left = real_vector @ real_vector / len(vector)
    if total @ total > left:
        part = real_basis @ real_vector / len(vector)
        real_vector -= part @ real_basis
        total += part
        left = real_vector @ real_vector / len(vector)
    return total, float(np.sqrt(left))
