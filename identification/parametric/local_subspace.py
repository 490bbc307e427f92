"""The extended observability matrix of one operating point from its frequency response."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from identification.arrays import ComplexArray, FloatArray
from identification.parametric.shift_basis import ShiftBasis
from identification.parametric.triangular import triangular_factor
from identification.signals import FrequencyResponse

Weighting = Literal["variance", "none"]


@dataclass(frozen=True, eq=False)
class LocalSubspace:
    """An estimate O (q n_y, n) of the observability matrix, and all singular values it was cut from (largest first)."""

    observability: FloatArray
    singular_values: FloatArray


def local_subspace(
    data: FrequencyResponse, z: ComplexArray, basis: ShiftBasis, order: int, weighting: Weighting
) -> LocalSubspace:
    """The n-dimensional subspace that the response leaves when what the inputs alone explain is projected out.

        [Re W Im W; Re G Im G] = [R₁₁ 0; R₂₁ R₂₂] Qᵀ,   K⁻¹ R₂₂ = U Σ Vᵀ,   O = K U_s        [Kergus2019, (7), (8)]

    W has the blocks φ_k(z_i) I/√F and G the blocks φ_k(z_i) Ĝ_i/√F at the lines z (F,); K Kᵀ = Re Σ φ(z_i) φ(z_i)ᴴ ⊗
    R_i/F with R_i the covariance of the noise summed over the inputs (equal for all lines when the data state none), or
    K = I for `weighting` "none" [Akcay2008, Algorithm 2].
    """
    phi = basis.evaluate(z) / np.sqrt(len(z))
    n_u = data.input_count
    identities = np.broadcast_to(np.eye(n_u), (len(z), n_u, n_u))
    stacked = np.concatenate([_blocks(phi, identities), _blocks(phi, data.matrices)])
    triangle = triangular_factor(np.hstack([stacked.real, stacked.imag]).T)
    top = basis.size * n_u
    remainder = triangle[top:, top:].T
    root = _noise_root(data, phi) if weighting == "variance" else np.eye(len(remainder))
    left, singular_values, _ = np.linalg.svd(solve_triangular(root, remainder, lower=True), full_matrices=False)
    return LocalSubspace(root @ left[:, :order], singular_values)


def _blocks(phi: ComplexArray, matrices: ComplexArray | FloatArray) -> ComplexArray:
    """φ_k(z_i) M_i as (q · rows, F · columns)."""
    product = phi[:, :, None, None] * matrices
    return np.asarray(product.transpose(0, 2, 1, 3).reshape(len(phi) * matrices.shape[1], -1))


def _noise_root(data: FrequencyResponse, phi: ComplexArray) -> FloatArray:
    covariance = output_covariance(data)
    size = len(phi) * data.output_count
    gram = np.einsum("kf,lf,fyv->kylv", phi, phi.conj(), covariance, optimize=True).real.reshape(size, size)
    gram += 1e-14 * np.trace(gram) / size * np.eye(size)
    return np.asarray(cholesky(gram, lower=True))


def output_covariance(data: FrequencyResponse) -> ComplexArray:
    """R_i, the covariance of a line's noise at the outputs summed over the inputs, (F, n_y, n_y), up to a factor."""
    f, n_y, n_u = data.matrices.shape
    if data.covariance is not None:
        entries = data.covariance.reshape(f, n_y, n_u, n_y, n_u)
        return np.asarray(np.einsum("fyuvu->fyv", entries))
    summed = np.full((f, n_y), float(n_u)) if data.variance is None else data.variance.reshape(f, n_y, n_u).sum(-1)
    return np.asarray((summed / summed.mean())[:, :, None] * np.eye(n_y), dtype=np.complex128)
