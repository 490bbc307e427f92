"""What every family of spectra offers to the solver."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, FloatArray, IntArray
from identification.comparison.batch import Batch
from identification.models.model import Model
from oed.subject import Subject

NEARLY = 0.97
MOST_OFFERED = 100
NEGLIGIBLE = 1e-15


@dataclass(frozen=True, eq=False)
class Block:
    """Spectra at one operating point, spanned by r shapes with a weight W (r, r) ⪰ 0.

    The input energy is tr W and the information Σ_ab W_ab `information`_ab; `information` is (r, r, k, k). What the
    rows of `shapes` mean is known to the family alone. `parts`, of a single shape: the rows of the parts of the
    parameters between which there is no information; `columns` B (k, q): the information is B Bᵀ within each of them.
    `use` (L, r, r): the share Σ_ab W_ab use_l,ab that the spectrum takes of each of L limits at its operating point.
    """

    point: int
    shapes: FloatArray
    information: FloatArray
    parts: tuple[slice, ...] = ()
    columns: FloatArray | None = None
    use: FloatArray | None = None

    def factor(self, part: slice) -> FloatArray:
        """B (k_part, q) with the information B Bᵀ within a part."""
        return root(self.information[0, 0][part, part]) if self.columns is None else self.columns[part]

    def total(self, weight: FloatArray) -> FloatArray:
        """Σ_ab W_ab information_ab, (k, k)."""
        return np.asarray(np.einsum("ab,abij->ij", weight, self.information))

    def taken(self, weight: FloatArray) -> FloatArray:
        """Σ_ab W_ab use_ab, (L,)."""
        return np.zeros(0) if self.use is None else np.einsum("ab,lab->l", weight, self.use)


def root(matrix: FloatArray) -> FloatArray:
    """L (k, r) with L Lᵀ the positive semidefinite matrix (k, k), few columns where it has few directions."""
    values, vectors = np.linalg.eigh(matrix)
    kept = values > NEGLIGIBLE * values.max(initial=0.0)
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))


Use = Callable[[FloatArray], FloatArray]


class Spectrum(Protocol):
    """The input spectrum of one local experiment, in units of energy."""

    @property
    def energy(self) -> float:
        """Σ_t u(t)² over the experiment."""

    def line_energies(self, samples: int, sample_time: float) -> tuple[IntArray, FloatArray]:
        """(indices, energies) of the lines 2πi/(samples · sample_time) of a periodic signal, i = 0 … samples/2."""


class Pricing(Protocol):
    """Spectra of one family at M operating points, searched for what they are worth.

    A family may offer several local experiments at an operating point; a block's `point` is the number of its
    experiment, and `places` gives the operating point of each.
    """

    @property
    def places(self) -> IntArray:
        """The operating points (E,) of the local experiments."""

    def limits(self, caps: FloatArray, samples: int) -> FloatArray:
        """The most energy (E,) in each, for caps (M,) at the operating points and experiments of `samples`."""

    def within(self, caps: FloatArray, samples: int) -> "Pricing":
        """The experiments that caps (M,) and `samples` allow."""

    def restricted(self, share: Use) -> "Pricing":
        """The same under limits, of which a mean square of one takes the share (L, M, F) at frequencies (F,)."""

    def flat(self) -> list[Block]:
        """At every point a spectrum of energy one that excites all frequencies of the band alike."""

    def best(
        self,
        prices: FloatArray,
        charges: FloatArray,
        blocks: Sequence[Block],
        weights: Sequence[FloatArray],
        tolls: FloatArray | None = None,
    ) -> "Offer":
        """The worth of the best spectra at prices Z (k, k), max ∫ (a* Z a − Σ_l ν_l w_l) Φ over Φ of energy one.

        `tolls` ν (L, M) are the prices of the limits, of which a spectrum takes w_l. Worth trying is what is worth more
        than its charge (M,), or nearly so. `blocks` and `weights` are the solution so far; the offered blocks contain
        it.
        """

    def transformed(self, basis: FloatArray, taken: float = 1.0) -> "Pricing":
        """The same for the parameters `basis`⁻¹ θ_G, whose information is basisᵀ (·) basis, with what energy takes of
        the limits times a factor.
        """

    def spectrum(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> Spectrum:
        """The spectrum that blocks of one local experiment make together."""


@dataclass(frozen=True, eq=False)
class Offer:
    """The worth (M,) of the best spectrum at each point, and blocks worth trying."""

    worth: FloatArray
    blocks: list[Block]


def foremost(candidates: BoolArray, excess: FloatArray) -> IntArray:
    """The numbers of the candidates, or of the MOST_OFFERED of them that exceed their charge most."""
    numbers = np.flatnonzero(candidates)
    if len(numbers) > MOST_OFFERED:
        numbers = numbers[np.argpartition(-excess[numbers], MOST_OFFERED)[:MOST_OFFERED]]
    return numbers


class SpectrumFamily(Protocol):
    """A parametrised set of spectra; the plug-ins of `oed.spectra`."""

    def pricing(
        self, subject: Subject, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> Pricing:
        """Prepare the family at the operating points (M, s), limited to a band (rad/s) where the family can be."""

    def reference(
        self, model: Model, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> tuple[Batch, ...]:
        """Experiments of the family without preference, for models to be fitted to each other; outputs zero."""
