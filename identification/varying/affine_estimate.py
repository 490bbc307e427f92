"""What estimators of affine state-space models return, with Cramér–Rao bounds on what does not depend on the basis."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError
from identification.models.recursion import propagate
from identification.outcome import Outcome, TestResult
from identification.varying.affine_parameters import AffineSizes
from identification.varying.affine_state_space import AffineStateSpace, frozen_matrices


@dataclass(frozen=True, eq=False)
class AffineEstimate:
    """A model, how the search ended, tests of its residual, and P_θ (size, size) for θ as in `AffineSizes`, or None.

    P_θ has the rank of what can be known, size − n_x²: it is the covariance among models in nearest state bases.
    """

    model: AffineStateSpace
    outcome: Outcome
    tests: tuple[TestResult, ...]
    covariance: FloatArray | None = None

    def eigenvalue_covariance(self) -> FloatArray:
        """Covariance of (Re λ, Im λ) for `model.eigenvalues()`, (1 + n_p, n_x, 2, 2) [Goos2014, Section 5].

            dλ = w* dA_i v / w* v,   A_i v = λ v,   w* A_i = λ w*

        Infinite at eigenvalues that coincide, which have no derivative. Raises NotIdentifiableError without P_θ.
        """
        sizes, covariance = AffineSizes.of(self.model), self._covariance()
        gradient = np.zeros((sizes.n_scheduling + 1, sizes.order, sizes.size), dtype=complex)
        _, right = np.linalg.eig(self.model.a)
        multiple = np.zeros(right.shape[:2], dtype=bool)
        for i, vectors in enumerate(right):
            multiple[i] = np.linalg.cond(vectors) > 1e8
            left = np.linalg.pinv(vectors)
            matrix = np.einsum("la,bl->lab", left, vectors).reshape(sizes.order, -1)
            gradient[i, :, i * sizes.order**2 : (i + 1) * sizes.order**2] = matrix
        result = complex_covariance(gradient, covariance)
        result[multiple] = np.inf
        return result

    def output_covariance(self, input: FloatArray, scheduling: FloatArray) -> FloatArray:
        """Covariance of the simulated output ŷ(t) along p (N, n_p) for u (N, n_u) from rest, (N, n_y, n_y).

        cov ŷ(t) = S(t) P_θ S(t)ᵀ,   S = ∂ŷ/∂θ from  δx(t+1) = A δx + δA x + δB u,   δy = C δx + δC x + δD u
        """
        total = np.zeros((len(input), self.model.n_outputs, self.model.n_outputs))
        for dy in self.output_changes(input, scheduling):
            total += dy[:, :, None] * dy[:, None, :]
        return total

    def output_changes(self, input: FloatArray, scheduling: FloatArray) -> Iterator[FloatArray]:
        """S(t) v (N, n_y) for one direction v after the other, Σ v vᵀ = P_θ; S as in `output_covariance`."""
        model, sizes = self.model, AffineSizes.of(self.model)
        a, b, c, _ = model.frozen(scheduling)
        x = propagate(a, (b @ input[:, :, None])[..., 0], np.zeros(sizes.order))[:-1]
        for direction in _root(self._covariance()).T:
            da, db, dc, dd = frozen_matrices(sizes.split(direction), scheduling)
            forcing = (da @ x[:, :, None] + db @ input[:, :, None])[..., 0]
            dx = propagate(a, forcing, np.zeros(sizes.order))[:-1]
            yield (c @ dx[:, :, None] + dc @ x[:, :, None] + dd @ input[:, :, None])[..., 0]

    def _covariance(self) -> FloatArray:
        if self.covariance is None or not np.all(np.isfinite(self.covariance)):
            raise NotIdentifiableError(
                "this estimate has no covariance: refine it by maximum likelihood, or excite more lines", "covariance"
            )
        return self.covariance


def complex_covariance(gradient: ComplexArray, covariance: FloatArray) -> FloatArray:
    """Covariance (..., 2, 2) of the real and imaginary part of numbers with the gradients (..., size)."""
    parts = np.stack([gradient.real, gradient.imag], axis=-2)
    return np.asarray(parts @ covariance @ np.swapaxes(parts, -1, -2))


def _root(covariance: FloatArray) -> FloatArray:
    """V with P = V Vᵀ, as many columns as P has rank."""
    values, vectors = np.linalg.eigh(covariance)
    kept = values > 1e-14 * max(float(values[-1]), 0.0)
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))
