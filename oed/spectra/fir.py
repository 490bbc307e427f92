"""Spectra of white noise through an FIR filter [Ghosh2018, (20)]."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from identification.arrays import FloatArray, IntArray
from identification.comparison.batch import Batch
from identification.errors import RangeError
from identification.models.model import Model
from oed.hypothesis import response_batch
from oed.spectra.family import NEARLY, Block, Offer, Use, foremost
from oed.subject import Subject

LARGEST_DEGREE = 1000
MOST_NEW = 3
NEGLIGIBLE = 1e-5
REFERENCE = 257
RESTRICTED = 2**14


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
        if not 0 <= self.degree <= LARGEST_DEGREE:
            raise RangeError(f"the degree is {self.degree}; it must lie between 0 and {LARGEST_DEGREE}", "degree")

    def pricing(
        self, subject: Subject, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> "FirPricing":
        """Prepare the moments at the operating points (M, s); raises RangeError when a band is asked for."""
        if band is not None:
            raise RangeError("an FIR spectrum has no band limits; use line spectra, or leave the band open", "band")
        return FirPricing(subject.moments(points, self.degree, sample_time), sample_time)

    def reference(
        self, model: Model, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> tuple[Batch, ...]:
        """The same energy on frequencies up to the Nyquist frequency, at every point."""
        return (response_batch(model, points, np.linspace(0, np.pi / sample_time, REFERENCE)),)

    @classmethod
    def example(cls) -> "FirSpectra":
        """A small one, for the conformance tests."""
        return cls(degree=4)


@dataclass(frozen=True, eq=False)
class FirPricing:
    """FIR filters h at M points: Φ = |h|², `moments` (M, L + 1, k, k); a block's shapes are orthonormal filters h.

    `use` (l, M, L + 1): the moments (1/2π) ∫ w cos(iΩ) dΩ of what energy takes of each limit.
    """

    moments: FloatArray
    sample_time: float
    use: FloatArray | None = None

    @property
    def places(self) -> IntArray:
        """One local experiment an operating point."""
        return np.arange(len(self.moments))

    def limits(self, caps: FloatArray, samples: int) -> FloatArray:
        """The caps; energy is spread over whatever time there is."""
        return caps

    def within(self, caps: FloatArray, samples: int) -> "FirPricing":
        """All experiments; each may have as little energy as it is given."""
        return self

    def restricted(self, share: Use) -> "FirPricing":
        """With moments of what the limits charge; raises RangeError where they leave out frequencies altogether."""
        omega = np.linspace(0.0, np.pi / self.sample_time, RESTRICTED + 1)
        shares = share(omega)
        if not np.all(np.isfinite(shares)):
            raise RangeError(
                "an FIR spectrum cannot leave out a band; limit its power there, or use line spectra", "limits"
            )
        moments = fft.irfft(shares, 2 * RESTRICTED, axis=-1)[..., : self.moments.shape[1]]
        return replace(self, use=np.asarray(moments))

    def flat(self) -> list[Block]:
        """White noise."""
        impulse = np.eye(1, self.moments.shape[1])
        return self._blocks(dict.fromkeys(range(len(self.moments)), impulse))

    def best(
        self,
        prices: FloatArray,
        charges: FloatArray,
        blocks: Sequence[Block],
        weights: Sequence[FloatArray],
        tolls: FloatArray | None = None,
    ) -> Offer:
        """The leading eigenvalue of the Toeplitz matrix of tr(Z · moments); its eigenvectors join those in use."""
        lags = self.moments.reshape(*self.moments.shape[:2], -1) @ prices.ravel()
        if tolls is not None and self.use is not None:
            lags = lags - np.einsum("lm,lmi->mi", tolls, self.use)
        order = np.arange(lags.shape[1])
        values, vectors = np.linalg.eigh(lags[:, abs(order[:, None] - order)])
        worth = values[:, -1]
        shapes: dict[int, FloatArray] = {}
        for block, weight in zip(blocks, weights, strict=True):
            kept = _active(block, weight)
            if len(kept):
                shapes[block.point] = _orthonormal(shapes[block.point], kept) if block.point in shapes else kept
        for m in foremost(worth > NEARLY * charges, worth - charges).tolist():
            new = vectors[m][:, values[m] > NEARLY * max(charges[m], worth[m])][:, -MOST_NEW:].T
            shapes[m] = _orthonormal(shapes[m], new) if m in shapes else new
        return Offer(worth, self._blocks(shapes))

    def transformed(self, basis: FloatArray, taken: float = 1.0) -> "FirPricing":
        """The same for the parameters basis⁻¹ θ_G."""
        use = None if self.use is None else taken * self.use
        return replace(self, moments=basis.T @ self.moments @ basis, use=use)

    def spectrum(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FirSpectrum:
        """c_i, the i-th autocorrelation of the filters, summed with their weights."""
        lags = _correlations(np.vstack([block.shapes for block in blocks]), [len(block.shapes) for block in blocks])
        lags = np.concatenate([weight.ravel() for weight in weights]) @ lags
        return FirSpectrum(np.asarray(lags), self.sample_time)

    def _blocks(self, shapes: dict[int, FloatArray]) -> list[Block]:
        if not shapes:
            return []
        taps, k = self.moments.shape[1:3]
        sizes = [len(filters) for filters in shapes.values()]
        lags = _correlations(np.vstack(list(shapes.values())), sizes)
        lags[:, 1:] *= 2
        made, start = [], 0
        for (point, filters), r in zip(shapes.items(), sizes, strict=True):
            own = lags[start : start + r * r]
            information = own @ self.moments[point].reshape(taps, -1)
            use = None if self.use is None else (self.use[:, point] @ own.T).reshape(-1, r, r)
            made.append(Block(point, filters, information.reshape(r, r, k, k), use=use))
            start += r * r
        return made


def _correlations(shapes: FloatArray, sizes: Sequence[int]) -> FloatArray:
    """Σ_s (h_a[s] h_b[s+i] + h_b[s] h_a[s+i])/2, i = 0 … L, of all pairs (a, b) in groups of rows: (pairs, L + 1)."""
    starts = np.cumsum([0, *sizes[:-1]])
    left = np.concatenate([_pairs(r)[0] + start for start, r in zip(starts, sizes, strict=True)])
    right = np.concatenate([_pairs(r)[1] + start for start, r in zip(starts, sizes, strict=True)])
    taps = shapes.shape[1]
    transforms = np.fft.rfft(shapes, 2 * taps, axis=1)
    products = transforms.real[left] * transforms.real[right] + transforms.imag[left] * transforms.imag[right]
    return np.fft.irfft(products, 2 * taps, axis=-1)[:, :taps]


def _active(block: Block, weight: FloatArray) -> FloatArray:
    if len(weight) == 1:
        return block.shapes if weight[0, 0] > NEGLIGIBLE else block.shapes[:0]
    values, vectors = np.linalg.eigh(weight)
    return np.asarray(vectors[:, values > NEGLIGIBLE].T @ block.shapes)


def _orthonormal(kept: FloatArray, new: FloatArray) -> FloatArray:
    """Orthonormal rows that span the orthonormal rows of both."""
    _, values, rows = np.linalg.svd(np.vstack([kept, new]), full_matrices=False)
    return np.asarray(rows[values > 1e-6])


@cache
def _pairs(size: int) -> tuple[IntArray, IntArray]:
    """All pairs (a, b) of `size` rows, b running fastest."""
    numbers = np.arange(size)
    return np.repeat(numbers, size), np.tile(numbers, size)
