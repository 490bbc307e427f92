"""The test of a curve whose coefficients are penalised: restricted likelihood ratio of no curve at all."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.diagnosis.signatures import Signature
from identification.places.place import Effect

RATIOS = np.geomspace(0.1, 1e4, 13)
MORE_RATIOS = np.geomspace(0.1, 1e12, 53)
LOOSE = 1e-2


def is_penalised(effect: Effect) -> bool:
    """Whether its amplitudes have a distribution before anything is measured."""
    return bool(np.any(effect.precision()))


@dataclass(frozen=True, eq=False)
class CurveTest:
    """z = Qᵀ basis r ~ N(0, 1 + τ² d) for amplitudes of variance τ² in the proportions of their penalties.

    `axes` Q (m, c) of what is left of the signature without the amplitudes that are next to free, d `sizes` (m,).

        −2 ln LR(τ) = Σ_i z_i² τ² d_i/(1 + τ² d_i) − ln(1 + τ² d_i),   the largest over τ ≥ 0

    As θ is projected out of the signature this is the restricted likelihood ratio of τ² = 0 [CrainiceanuRuppert2004].
    """

    axes: FloatArray
    sizes: FloatArray

    @classmethod
    def of(cls, signature: Signature) -> "CurveTest":
        """For the signature of a penalised effect."""
        one = signature.placed
        precision = np.repeat(one.effect.precision(), one.coefficients.shape[1])
        free = precision < LOOSE * precision.max()
        gain = signature.gain / np.sqrt(np.where(free, 1.0, precision / precision.max()))
        taken = gain[:, free]
        q, size, _ = np.linalg.svd(taken, full_matrices=True)
        left = q[:, int(np.sum(size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300))) :]
        inner = left.T @ gain[:, ~free]
        values, vectors = np.linalg.eigh(inner @ inner.T)
        kept = values > 1e-9 * max(values[-1], 1e-300) if len(values) else np.zeros(0, dtype=np.bool_)
        return cls((left @ vectors[:, kept]).T, values[kept])

    def ratio(self, projections: FloatArray) -> FloatArray:
        """The largest likelihood ratio (…,) for basis r (…, c), over the ratios that noise alone can come to."""
        squares = (projections @ self.axes.T) ** 2
        best = np.zeros(squares.shape[:-1])
        for ratio in RATIOS if len(self.sizes) else ():
            best = np.maximum(best, self._at(squares, ratio / self.sizes[-1]))
        return best

    def size(self, projections: FloatArray) -> tuple[float, float]:
        """−2 ln LR at its largest and the τ there, for basis r (c,); (0, 0) where there is no curve."""
        squares = (projections @ self.axes.T) ** 2
        if not len(self.sizes):
            return 0.0, 0.0
        values = [float(self._at(squares, ratio / self.sizes[-1])) for ratio in MORE_RATIOS]
        best = int(np.argmax(values))
        return (values[best], float(np.sqrt(MORE_RATIOS[best] / self.sizes[-1]))) if values[best] > 0 else (0.0, 0.0)

    def _at(self, squares: FloatArray, variance: float) -> FloatArray:
        grown = variance * self.sizes
        return np.asarray(squares @ (grown / (1 + grown)) - np.sum(np.log1p(grown)))

    def log_determinant(self, size: float) -> float:
        """Σ ln(1 + τ² d): the price of a curve of this size."""
        return float(np.sum(np.log1p(size**2 * self.sizes)))
