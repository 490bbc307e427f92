"""Eigenvalues of the matrices A_j of a state-space model, which depend on no state basis, with their covariance."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.models.model import Model
from identification.models.state_space_model import stacks


def eigenvalues(model: Model) -> ComplexArray:
    """Those of each A_j, (functions, n_x) [Goos2014, Section 5]."""
    return np.asarray(np.linalg.eigvals(stacks(model)[0]), dtype=np.complex128)


def eigenvalue_covariance(model: Model) -> FloatArray:
    """Covariance of (Re λ, Im λ) for `eigenvalues`, (functions, n_x, 2, 2), from that of the entries of A_j.

    Infinite at eigenvalues that coincide, which have no derivative. Raises MisuseError without a covariance.
    """
    a = stacks(model)[0]
    k, n = a.shape[:2]
    matrices = np.zeros((k, model.structure.size))
    matrices[:, : n * n] = a.reshape(k, -1)
    gradient = model.structure.pole_gradient(matrices)[1][..., : n * n]
    of_a = model.theta_covariance[: a.size, : a.size].reshape(k, n * n, k, n * n)
    own = np.stack([of_a[j, :, j] for j in range(k)])
    known = np.isfinite(gradient)
    kept = np.where(known, gradient, 0)
    parts = np.stack([kept.real, kept.imag], axis=-2)
    found = parts @ own[:, None] @ np.swapaxes(parts, -1, -2)
    found[~np.all(known, axis=-1)] = np.inf
    return np.asarray(found)
