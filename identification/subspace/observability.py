"""The range of the extended observability matrix, and A and C from it."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError
from identification.subspace.dominant import dominant_left_vectors
from identification.subspace.noise import Noise, divide, multiply, root_of
from identification.subspace.polynomials import OrthonormalPolynomials
from identification.subspace.streaming import compressed_rows, representative_polynomials
from identification.subspace.transition import Stability, Transition, projected, transition_matrix

MANY = 1 << 21  # complex numbers in all rows: beyond, they are never formed at once
COLUMNS = 1 << 13  # treated at a time, so that they stay in the cache


@dataclass(frozen=True, eq=False)
class ObservabilityRange:
    """Estimated columns of an extended observability matrix, most important first.

        O_i = C φ_i(A),  i = 0 … q − 1,   φ_i A = Σ_j h_ji φ_j,  φ_0 = 1

    With φ_i = z^i it is [C; CA; … ; CA^{q−1}] [Akcay2008, Problem Formulation]. `columns` (n_y, q, r), r the highest
    order that the data show; `singular_values`; `shift` (q, q) holds the h_ji, ‖shift‖ ≤ 1.
    """

    columns: FloatArray
    singular_values: FloatArray
    shift: FloatArray

    @property
    def highest_order(self) -> int:
        """The number of columns found."""
        return int(self.columns.shape[2])

    def system(
        self, order: int, transition: Transition = "least_squares", stability: Stability = "none"
    ) -> tuple[FloatArray, FloatArray]:
        """A (n, n) and C (n_y, n) of order n.

        `stability` "maciejowski" leaves out what the last block row is shifted to, so that A is similar to a
        compression of the contraction `shift` and stable, at the price of an error; "projection" moves unstable
        eigenvalues inside [Akcay2008, Guaranteeing stability]. Raises NotIdentifiableError where the data have a
        lower order.
        """
        if order > self.highest_order:
            raise NotIdentifiableError(
                f"the data show order {self.highest_order} only, {order} was asked for; choose a lower order", "order"
            )
        o = self.columns[:, :, :order]
        shifted = np.einsum("ji,pjn->pin", self.shift, o)
        kept = slice(None) if stability == "maciejowski" else slice(-1)
        method = "least_squares" if stability == "maciejowski" else transition
        a = transition_matrix(o[:, kept].reshape(-1, order), shifted[:, kept].reshape(-1, order), method)
        return projected(a) if stability != "none" else a, o[:, 0]


def observability_range(
    z: ComplexArray, response: ComplexArray, noise: Noise, block_rows: int, count: int, unweighted: bool = False
) -> ObservabilityRange:
    """The first `count` columns from Ĝ (F, n_y, n_u) at arbitrary distinct z (F,) on the unit circle.

        [Re W Im W; Re G Im G] = [R_11 0; R_21 R_22] Qᵀ,   K⁻¹ R_22 = U Σ Vᵀ,   O = K U_s   [Akcay2008, Algorithm 2]

    R_22 R_22ᵀ is that of the rows φ_i(z_k) Ĝ_k after the projection on the rows φ_i(z_k) I has been subtracted; no
    factorisation of all rows is needed. Very many lines are compressed block by block. `unweighted` takes K = I with
    the powers z^i.
    """
    n_y = response.shape[1]
    if block_rows * response.size > MANY:
        polynomials = representative_polynomials(z, block_rows)
        rows, gram = compressed_rows(polynomials, z, response, noise)
        factors: FloatArray | None = _powers(polynomials.shift, n_y) if unweighted else root_of(gram)
        rows = divide(np.asarray(factors), rows)
    else:
        polynomials = OrthonormalPolynomials.on(z, block_rows)
        factors = _powers(polynomials.shift, n_y) if unweighted else noise.factors(polynomials.values)
        rows = _projected_rows(polynomials.values, factors, response)
    vectors, sizes = dominant_left_vectors(rows, min(count, len(rows)))
    columns = multiply(factors, vectors.reshape(n_y, block_rows, -1))
    return ObservabilityRange(columns, sizes, polynomials.shift)


def _projected_rows(values: ComplexArray, factors: FloatArray | None, response: ComplexArray) -> FloatArray:
    """K⁻¹ 𝒢 𝒲^⊥ / √F, (n_y q, 2 n_u F), for the polynomials (q, F) and Ĝ (F, n_y, n_u)."""
    (size, count), (_, n_y, n_u) = values.shape, response.shape
    rows = np.empty((n_y, size, n_u, count), dtype=np.complex128)
    scaled = response / np.sqrt(count)
    for i in range(n_y):
        weighted = values
        if factors is not None and factors.ndim == 3:
            weighted = _solved(factors[i], values)
        for j in range(n_u):
            np.multiply(weighted, scaled[:, i, j], out=rows[i, :, j])
    if factors is not None and factors.ndim == 2:
        rows = _solved(factors, rows.reshape(n_y * size, -1))
    _project_out(rows.view(np.float64).reshape(n_y, size * n_u, 2 * count), values.view(np.float64))
    return rows.view(np.float64).reshape(n_y * size, -1)


def _solved(factor: FloatArray, rows: ComplexArray) -> ComplexArray:
    """K⁻¹ X for a lower triangular K (R, R) and X (R, N)."""
    solved = solve_triangular(factor, rows.view(np.float64), lower=True)
    return np.ascontiguousarray(solved).view(np.complex128)


def _project_out(rows: FloatArray, basis: FloatArray) -> None:
    """Subtracts from each of several matrices (…, R, N) its projection on a basis (q, N) of norm √(N/2), in place."""
    for some in rows:
        part = some @ basis.T * (2 / basis.shape[1])
        for first in range(0, basis.shape[1], COLUMNS):
            here = slice(first, first + COLUMNS)
            some[:, here] -= part @ basis[:, here]


def _powers(shift: FloatArray, outputs: int) -> FloatArray:
    """K that stands for K = I with powers in place of polynomials: z^i = Σ_j L_ij φ_j, K = L⁻¹, (n_y, q, q)."""
    size = len(shift)
    lower = np.zeros((size, size))
    lower[0, 0] = 1.0
    for i in range(1, size):
        lower[i] = shift @ lower[i - 1]
    inverse = solve_triangular(lower, np.eye(size), lower=True)
    return np.broadcast_to(inverse, (outputs, size, size))
