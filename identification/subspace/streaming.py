"""What the subspace methods need of very many lines, gathered block by block."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.subspace.compression import triangle
from identification.subspace.noise import Noise
from identification.subspace.polynomials import OrthonormalPolynomials

REPRESENTATIVE = 1 << 14  # lines that the polynomials are made orthonormal on
NUMBERS = 1 << 17  # treated at a time


def representative_polynomials(z: ComplexArray, count: int) -> OrthonormalPolynomials:
    """Polynomials orthonormal on evenly chosen lines out of very many: nearly so on all of them."""
    return OrthonormalPolynomials.on(np.ascontiguousarray(z[:: -(-len(z) // REPRESENTATIVE)]), count)


def compressed_rows(
    polynomials: OrthonormalPolynomials, z: ComplexArray, response: ComplexArray, noise: Noise
) -> tuple[FloatArray, FloatArray]:
    """X (n_y q, n_u n_y q) with X Xᵀ = 𝒢 𝒲^⊥ 𝒢ᵀ, and K Kᵀ of the noise, for z (F,) and Ĝ (F, n_y, n_u).

        [𝒲_j; 𝒢_j] = [R_11 0; R_21 R_22]_j Q_jᵀ for every input j,   X = [R_22,1 … R_22,n_u]

    Each triangle is carried from block to block, so that the memory needed does not grow with the number of lines.
    """
    size, (count, n_y, n_u) = len(polynomials.shift), response.shape
    factors: list[FloatArray | None] = [None] * n_u
    step = max(NUMBERS // ((1 + n_y) * size), (1 + n_y) * size)
    gram = np.zeros(1)
    for first in range(0, count, step):
        here = slice(first, first + step)
        values = polynomials.elsewhere(z[here])
        answers = response[here].transpose(2, 1, 0)[:, :, None]
        stacked = np.empty((1 + n_y, size, values.shape[1]), dtype=np.complex128)
        stacked[0] = values
        for j in range(n_u):
            np.multiply(values, answers[j], out=stacked[1:])
            factors[j] = triangle([stacked.reshape(-1, values.shape[1]).view(np.float64)], factors[j])
        gram = gram + noise.part(here).gram(values)
    lower = [np.asarray(f)[size:, size:].T for f in factors]
    return np.concatenate(lower, axis=1) / np.sqrt(count), np.asarray(gram / count)
