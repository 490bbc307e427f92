"""Spectra of white noise through an FIR filter [Ghosh2018, (20)]."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import FloatArray, IntArray
from identification.errors import RangeError
from identification.models import LpvModel
from identification.signals import OperatingPoint
from oed.information import sensitivity_moments
from oed.spectra.family import NEARLY, Block, Offer

MOST_NEW = 3


@dataclass(frozen=True, eq=False)
class FirSpectrum:
    """N_p Φ(ω) = c_0 + 2 Σ_i c_i cos(iωT) in units of energy, `coefficients` (L + 1,) [Ghosh2018, (20)]."""

    coefficients: FloatArray
    sample_time: float

    @property
    def energy(self) -> float:
        """Σ_t u(t)² over the experiment: c_0."""
        return float(self.coefficients[0])

    def density(self, omega: FloatArray) -> FloatArray:
        """N_p Φ at ω (F,) in rad/s, as (F,)."""
        lags = np.arange(len(self.coefficients))
        cosines = np.cos(np.outer(omega * self.sample_time, lags))
        return np.asarray(cosines @ (self.coefficients * np.where(lags == 0, 1.0, 2.0)))

    def information(self, model: LpvModel, point: OperatingPoint, sample_time: float) -> FloatArray:
        """c_0 M_0 + 2 Σ c_i M_i with the moments M_i of the sensitivity, (k_G, k_G)."""
        twice = np.where(np.arange(len(self.coefficients)) == 0, 1.0, 2.0) * self.coefficients
        return np.asarray(sensitivity_moments(model, [point], len(twice) - 1, sample_time)[0] @ twice)

    def line_energies(self, samples: int, sample_time: float) -> tuple[IntArray, FloatArray]:
        """The density sampled at the lines of a period of `samples`, scaled to the same energy."""
        indices = np.arange(samples // 2 + 1)
        frequencies = np.asarray(2 * np.pi * indices / (samples * sample_time))
        density = np.maximum(self.density(frequencies), 0.0)
        twice = np.where((indices == 0) | (2 * indices == samples), 1.0, 2.0)
        energies = density * twice
        return indices, np.asarray(energies * (self.energy / energies.sum()))


@dataclass(frozen=True)
class FirSpectra:
    """Spectra of white noise through an FIR filter of a degree L, Φ(ω) = c_0 + 2 Σ_{i=1}^L c_i cos(iωT) ≥ 0
    [Ghosh2018, (20)].

    Smooth, so that every local experiment identifies its local model. A smaller degree costs energy. The frequency
    band cannot be limited.
    """

    kind: ClassVar[str] = "fir"

    degree: Annotated[int, "degree L of the FIR filter"]

    def __post_init__(self) -> None:
        if self.degree < 0:
            raise RangeError(f"the degree is {self.degree}; it must be zero or more", "degree")

    def pricing(
        self, model: LpvModel, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> "FirPricing":
        """Prepare the moments at the operating points (M, s); raises RangeError when a band is asked for."""
        if band is not None:
            raise RangeError("an FIR spectrum has no band limits; use line spectra, or leave the band open", "band")
        return FirPricing(sensitivity_moments(model, points, self.degree, sample_time), sample_time)

    @classmethod
    def example(cls) -> "FirSpectra":
        """A small one, for the conformance tests."""
        return cls(degree=4)


@dataclass(frozen=True, eq=False)
class FirPricing:
    """FIR filters h at M points: Φ = |h|², `moments` (M, k, k, L + 1); a block's shapes are orthonormal filters h."""

    moments: FloatArray
    sample_time: float

    def flat(self) -> list[Block]:
        """White noise."""
        impulse = np.eye(1, self.moments.shape[-1])
        return [self._block(m, impulse) for m in range(len(self.moments))]

    def best(
        self, prices: FloatArray, charges: FloatArray, blocks: Sequence[Block], weights: Sequence[FloatArray]
    ) -> Offer:
        """The leading eigenvalue of the Toeplitz matrix of tr(Z · moments); its eigenvectors join those in use."""
        lags = np.einsum("ij,mijl->ml", prices, self.moments)
        order = np.arange(lags.shape[1])
        values, vectors = np.linalg.eigh(lags[:, abs(order[:, None] - order)])
        in_use = {block.point: _active(block, weight) for block, weight in zip(blocks, weights, strict=True)}
        offered = []
        for m, value in enumerate(values):
            kept = in_use.get(m, np.zeros((0, len(order))))
            good_enough = max(NEARLY * charges[m], NEARLY * value[-1])
            if len(kept) or value[-1] > good_enough:
                leading = vectors[m][:, value > good_enough][:, -MOST_NEW:]
                offered.append(self._block(m, _orthonormal(kept, leading.T)))
        return Offer(values[:, -1], offered)

    def transformed(self, basis: FloatArray) -> "FirPricing":
        """The same for the parameters basis⁻¹ θ_G."""
        return FirPricing(np.einsum("ai,mabl,bj->mijl", basis, self.moments, basis, optimize=True), self.sample_time)

    def spectrum(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FirSpectrum:
        """c_i, the i-th autocorrelation of the filters, summed with their weights."""
        pairs = zip(blocks, weights, strict=True)
        lags = sum(np.einsum("ab,abl->l", weight, _correlations(block.shapes)) for block, weight in pairs)
        return FirSpectrum(np.asarray(lags), self.sample_time)

    def _block(self, point: int, shapes: FloatArray) -> Block:
        lags = _correlations(shapes) * np.where(np.arange(shapes.shape[1]) == 0, 1.0, 2.0)
        return Block(point, shapes, np.einsum("abl,ijl->abij", lags, self.moments[point], optimize=True))


def _correlations(shapes: FloatArray) -> FloatArray:
    """Symmetric correlations Σ_s (h_a[s] h_b[s+i] + h_b[s] h_a[s+i])/2, as (r, r, L + 1)."""
    taps = shapes.shape[1]
    spectra = np.fft.rfft(shapes, 2 * taps, axis=1)
    products = (spectra[:, None] * spectra[None].conj()).real
    return np.asarray(np.fft.irfft(products, 2 * taps, axis=-1)[..., :taps])


def _active(block: Block, weight: FloatArray) -> FloatArray:
    values, vectors = np.linalg.eigh(weight)
    return np.asarray(vectors[:, values > 1e-7 * max(values[-1], 1e-12)].T @ block.shapes)


def _orthonormal(kept: FloatArray, new: FloatArray) -> FloatArray:
    """An orthonormal basis of the rows of both."""
    _, values, rows = np.linalg.svd(np.vstack([kept, new]), full_matrices=False)
    return np.asarray(rows[values > 1e-8])
