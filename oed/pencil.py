"""What is known and what experiments could tell, in coordinates in which both are diagonal."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from identification.arrays import BoolArray, FloatArray

EPSILON = float(np.finfo(np.float64).eps)
CANCELLED = 1e-14
COARSEST = 1e-6
LARGEST = 1e100
LEAST = 1e-60
ABOVE = 1e-12


@dataclass(frozen=True, eq=False)
class Pencil:
    """Two informations about θ (k,), diagonal in coordinates x (r,): prior Π = Tᵀ diag(π) T and gain X = Tᵀ diag(ξ) T.

    θ = B x + N z with T B = I, and z (k − r,) is what neither tells anything about. The rows of factors of Π and X are
    stacked, not the matrices added, so that directions of which one tells 1e20 times as much as the other are resolved
    (the generalised singular value decomposition [PaigeSaunders1981]). Eigenvalues that rounding alone could have made
    count as zero: less is claimed to be known, never more.
    """

    basis: FloatArray
    coordinates: FloatArray
    prior: FloatArray
    gain: FloatArray
    scale: FloatArray
    unknown: FloatArray
    blur: float

    @classmethod
    def of(cls, prior: FloatArray, gain: FloatArray) -> "Pencil":
        """The coordinates for Π and X (k, k), both positive semidefinite."""
        known, told = (np.maximum(np.diagonal(one), 0.0) for one in (prior, gain))
        both = (known > 0) & (told > 0)
        ratio = float(np.exp(np.mean(np.log(known[both] / told[both])))) if both.any() else 1.0
        size = np.sqrt(known / ratio + told)
        scale = np.where(size > 0, size, 1.0)
        upper, lower = _factor(prior) / np.sqrt(ratio) / scale, _factor(gain) / scale
        left, values, rows = np.linalg.svd(np.vstack([upper, lower]), full_matrices=True)
        values = np.pad(values, (0, len(scale) - len(values)))
        kept = values > np.sqrt(_rounding(len(scale))) * values.max(initial=0.0)
        columns = left[:, : len(values)][:, kept[: left.shape[1]]]
        _, _, turned = np.linalg.svd(columns[: len(upper)], full_matrices=True)
        cosine = np.linalg.norm(columns[: len(upper)] @ turned.T, axis=0)
        sine = np.linalg.norm(columns[len(upper) :] @ turned.T, axis=0)
        return cls(
            (rows[kept].T / values[kept]) @ turned.T / scale[:, None],
            turned @ (values[kept, None] * rows[kept]) * scale,
            ratio * cosine**2,
            sine**2,
            scale,
            rows[~kept].T,
            min(_rounding(len(scale)) / float(values[kept].min(initial=1.0)) ** 2, COARSEST),
        )

    def unreached(self, targets: FloatArray) -> BoolArray:
        """Which targets R_j (J, k, k) ask for something that neither tells anything about, (J,)."""
        asked = targets / np.outer(self.scale, self.scale)
        within = np.einsum("an,jab,bn->jn", self.unknown, asked, self.unknown)
        least = np.maximum(CANCELLED * self.unknown**2, self.blur**2)
        return np.asarray(np.any(within > np.diagonal(asked, axis1=1, axis2=2) @ least, axis=1))

    def asked(self, targets: FloatArray, energy: float) -> FloatArray:
        """R_j where Π + `energy` X is the unit matrix, (J, r, r)."""
        scaled = self.basis / np.sqrt(np.maximum(self.prior + energy * self.gain, LEAST))
        return np.asarray(scaled.T @ targets @ scaled)

    def least(self, targets: FloatArray) -> float:
        """The least s ≥ 0 with Π + s X ⪰ R_j for all j; infinite where there is none."""
        if self.unreached(targets).any():
            return np.inf
        return _crossing(lambda s: float(largest_eigenvalues(self.asked(targets, s)).max(initial=0.0)))

    def enough(self, targets: FloatArray) -> float:
        """An s with Π + s X ⪰ R_j for all j, at most r times the least: from traces of reached targets."""
        squares = np.einsum("ai,jab,bi->ji", self.basis, targets, self.basis, optimize=True)
        return _crossing(
            lambda s: float((squares @ (1 / np.maximum(self.prior + s * self.gain, LEAST))).max(initial=0.0))
        )


def shares(prior: FloatArray, gain: FloatArray, targets: FloatArray) -> FloatArray:
    """The least s_j with s_j (prior + gain) ⪰ R_j (J, k, k): at most one where the target is met, (J,).

    Each target is judged in its own directions, whatever their units and sizes: infinite where it asks for something of
    which nothing is known.
    """
    pencil = Pencil.of(prior, gain)
    result = largest_eigenvalues(pencil.asked(targets, 1.0)) if pencil.prior.size else np.zeros(len(targets))
    return np.asarray(np.where(pencil.unreached(targets), np.inf, result))


def covariance_of(prior: FloatArray, gain: FloatArray) -> FloatArray:
    """(prior + gain)⁻¹ (k, k) for all parameters that are determined; infinite for the others and all covariances with
    them.
    """
    pencil = Pencil.of(prior, gain)
    k = len(prior)
    single = np.zeros((k, k, k))
    single[np.arange(k), np.arange(k), np.arange(k)] = 1.0
    known = ~pencil.unreached(single)
    covariance = (pencil.basis / (pencil.prior + pencil.gain)) @ pencil.basis.T
    return np.asarray(np.where(np.outer(known, known), covariance, np.inf))


def _rounding(k: int) -> float:
    return 8 * k * EPSILON


def _factor(information: FloatArray) -> FloatArray:
    """Rows (·, k) whose Gram matrix is the information, less what rounding could have made of it."""
    size = np.sqrt(np.maximum(np.diagonal(information), 0.0))
    scale = np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh((information + information.T) / 2 / np.outer(scale, scale))
    values = values - _rounding(len(scale)) * values.max(initial=0.0)
    kept = values > 0
    return np.asarray((vectors[:, kept] * np.sqrt(values[kept])).T * size)


def largest_eigenvalues(matrices: FloatArray, relative: bool = False) -> FloatArray:
    """The largest eigenvalue of each symmetric matrix (J, k, k), or where it cannot matter a bound of it, (J,).

        m + s/√(k − 1) ≤ λ ≤ m + s √(k − 1),   m = tr A/k,  s² = tr A²/k − m²       [WolkowiczStyan1980, Theorem 2.1]

    It matters where it may exceed one or be the largest of all, with `relative` where it may be the largest of all.
    """
    size = matrices.shape[-1]
    trace = np.trace(matrices, axis1=1, axis2=2)
    spread = np.maximum(np.einsum("jab,jab->j", matrices, matrices) - trace**2 / max(size, 1), 0.0) / max(size, 1)
    result = trace / max(size, 1) + np.sqrt(max(size - 1, 0) * spread)
    if size and len(matrices):
        least = float((trace / size + np.sqrt(spread / max(size - 1, 1))).max())
        high = np.flatnonzero(result >= least if relative else result >= min(least, 1.0))
        result[high] = np.linalg.eigvalsh(matrices[high])[:, -1]
    return np.asarray(result)


def _crossing(share: Callable[[float], float]) -> float:
    """The least s ≥ 0 at which a share that falls with s is at most one; infinite where it never is."""
    if share(0.0) <= 1:
        return 0.0
    high = 1.0
    while share(high) > 1:
        high *= 4
        if high > LARGEST:
            return np.inf
    while high > 1 / LARGEST and share(high / 4) <= 1:
        high /= 4

    def excess(logarithm: float) -> float:
        return float(np.log(max(share(float(np.exp(logarithm))), LEAST)))

    top = float(np.log(high))
    if excess(top - np.log(4)) <= 0:
        return high / 4
    if excess(top) >= 0:
        return high
    return float(np.exp(brentq(excess, top - np.log(4), top, xtol=1e-13)) * (1 + ABOVE))
