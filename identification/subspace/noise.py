"""The noise of a frequency response as the subspace methods use it: weights of lines, and K."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Self

import numpy as np
from scipy.linalg import solve_triangular

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError, RangeError
from identification.signals import FrequencyResponse

Weighting = Literal["automatic", "variance", "equal", "none"]

EXTREME = 1e30


@dataclass(frozen=True, eq=False)
class Noise:
    """`weights` (F, n_y, n_u), the inverse standard deviations, and `covariance` (F, m, m), m = n_y n_u, or None."""

    weights: FloatArray
    covariance: ComplexArray | None = None

    @classmethod
    def of(cls, data: FrequencyResponse, weighting: Weighting) -> Self:
        """That of a measurement; raises MisuseError where "variance" is asked for and there is none."""
        if weighting == "variance" and data.variance is None:
            raise MisuseError(
                "the frequency response carries no variance; give one or use the weighting 'equal'", "weighting"
            )
        shape = data.matrices.shape
        if weighting != "equal" and data.variance is not None and data.variance.max() / EXTREME > data.variance.min():
            raise RangeError(
                f"the variances differ by more than a factor {EXTREME:.0g}; leave out lines that are known too badly",
                "variance",
            )
        if weighting in ("equal", "none") or data.variance is None:
            return cls(np.ones(shape))
        # Only ratios matter: scaled so that squares neither overflow nor vanish.
        scale = float(np.median(data.variance))
        covariance = None if data.covariance is None else data.covariance / scale
        return cls(np.sqrt(scale / data.variance.reshape(shape)), covariance)

    @cached_property
    def same_for_inputs(self) -> bool:
        """Whether one weight a line and output does for all inputs."""
        return bool(np.all(self.weights == self.weights[..., :1]))

    def whiten(self, entries: ComplexArray) -> ComplexArray:
        """L_k⁻¹ x_k with R_k = L_k L_kᴴ, for x (F, m, c) and m = n_y n_u correlated entries."""
        assert self.covariance is not None
        return np.asarray(np.linalg.solve(np.linalg.cholesky(self.covariance), entries))

    @cached_property
    def equal(self) -> bool:
        """Whether it is the same on all lines, and uncorrelated."""
        return self.covariance is None and np.ptp(self.weights) == 0

    def part(self, lines: slice) -> "Noise":
        """The noise of some of the lines."""
        return Noise(self.weights[lines], None if self.covariance is None else self.covariance[lines])

    def gram(self, values: ComplexArray) -> FloatArray:
        """Re Σ_k R_k ⊗ φ(z_k) φ(z_k)ᴴ for φ (q, F): (n_y, q, q), one an output, or (n_y q, n_y q) when correlated.

        R_k is the mean of E n_kj n_kjᴴ over the inputs j [Akcay2008, (3)].
        """
        size, (count, n_y, n_u) = len(values), self.weights.shape
        if self.covariance is None:
            deviations = np.sqrt(np.mean(self.weights**-2.0, axis=2)).T
            real = np.ascontiguousarray(values * deviations[:, None, :]).view(np.float64)
            return np.asarray(real @ np.swapaxes(real, -1, -2))
        between = np.einsum("kajbj->kab", self.covariance.reshape(count, n_y, n_u, n_y, n_u)) / n_u
        pairs = (values[:, None, :] * values.conj()).reshape(-1, count)
        blocks = np.real(pairs @ between.reshape(count, -1)).reshape(size, size, n_y, n_y)
        return np.asarray(blocks.transpose(2, 0, 3, 1).reshape(n_y * size, n_y * size))

    def factors(self, values: ComplexArray) -> FloatArray | None:
        """K for polynomials φ (q, F) that are orthonormal on the lines; None for K = I, where the noise is equal."""
        return None if self.equal else root_of(self.gram(values) / values.shape[1])


def root_of(gram: FloatArray) -> FloatArray:
    """K, lower triangular, K Kᵀ = Re Σ_k R_k ⊗ φ φᴴ [Akcay2008, (3)].

    With φ_i in place of z^i here and in the data the singular values and the subspace stay the same.
    Raises MisuseError where the variances leave too few lines.
    """
    try:
        return np.asarray(np.linalg.cholesky(gram))
    except np.linalg.LinAlgError:
        raise MisuseError(
            "the variances differ so much that few lines carry all weight; leave out lines that are known too badly,"
            " use fewer block rows or the weighting 'equal'",
            "variance",
        ) from None


def divide(factors: FloatArray, rows: FloatArray) -> FloatArray:
    """K⁻¹ X for X (n_y q, c)."""
    if factors.ndim == 2:
        return np.asarray(solve_triangular(factors, rows, lower=True))
    parts = zip(factors, np.split(rows, len(factors)), strict=True)
    return np.concatenate([solve_triangular(factor, part, lower=True) for factor, part in parts])


def multiply(factors: FloatArray | None, rows: FloatArray) -> FloatArray:
    """K X for X (n_y, q, c)."""
    if factors is None:
        return rows
    if factors.ndim == 3:
        return np.asarray(factors @ rows)
    return np.asarray(factors @ rows.reshape(len(factors), -1)).reshape(rows.shape)
