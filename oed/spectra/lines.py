"""Line spectra: power at the lines of a periodic record only."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, FloatArray, IntArray
from identification.comparison.batch import Batch
from identification.errors import RangeError
from identification.models.model import Model
from oed.hypothesis import response_batch
from oed.spectra.family import NEARLY, Block, Offer, Use, foremost, root
from oed.subject import Subject

MOST_SENSITIVITIES = 2**26
MOST_REFERENCE = 256
SENSITIVITIES_AT_ONCE = 2**22


@dataclass(frozen=True, eq=False)
class LineSpectrum:
    """Energies Σ_t u(t)² (K,) at `frequencies` (K,) in rad/s, each the line `indices` (K,) of a record of `samples`."""

    frequencies: FloatArray
    energies: FloatArray
    indices: IntArray
    samples: int

    @property
    def energy(self) -> float:
        """Σ_t u(t)² over the experiment."""
        return float(self.energies.sum())

    def line_energies(self, samples: int, sample_time: float) -> tuple[IntArray, FloatArray]:
        """The lines of a period of `samples`; raises RangeError unless every designed line is one of them."""
        indices = np.rint(self.frequencies * samples * sample_time / (2 * np.pi)).astype(np.int64)
        exact = 2 * np.pi * indices / (samples * sample_time)
        if np.any(abs(exact - self.frequencies) > 1e-9 * np.pi / sample_time):
            raise RangeError(
                f"a period of {samples} samples does not hold the designed lines; use a multiple of {self.samples}",
                "samples",
            )
        return indices, self.energies


@dataclass(frozen=True)
class LineSpectra:
    """Line spectra Φ(ω) = Σ_i E_i δ(ω − ω_i) on the lines ω_i = 2πi/(samples · T) of a periodic record.

    The lowest line is the first, i = 1, unless a `constant` is asked for. The least energy of all spectra; few lines,
    so that a local experiment alone may not identify its local model (then estimate θ jointly).
    """

    kind: ClassVar[str] = "lines"

    samples: Annotated[int, "samples per period of the record whose lines may be used"]
    constant: Annotated[bool, "the constant, line 0, may be used too; it shows nothing of the dynamics"] = False

    def __post_init__(self) -> None:
        if self.samples < 2:
            raise RangeError(f"a period of {self.samples} samples has no lines; use more samples", "samples")

    def pricing(
        self, subject: Subject, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> "LinePricing":
        """Prepare the lines inside the band at the operating points (M, s); raises RangeError for an empty band."""
        indices, frequencies = self._lines(band, sample_time)
        if len(frequencies) * np.shape(points)[0] * subject.size > MOST_SENSITIVITIES:
            raise RangeError(
                f"{len(frequencies)} lines at {np.shape(points)[0]} operating points are more than fits into memory;"
                " use fewer samples per period, a narrower band, or fewer operating points",
                "samples",
            )
        p = np.asarray(points, dtype=np.float64)
        at_once = max(1, SENSITIVITIES_AT_ONCE // (len(frequencies) * subject.size))
        rows = np.empty((len(p), len(frequencies), 2, subject.size))
        for start in range(0, len(p), at_once):
            here = subject.sensitivity(p[start : start + at_once], frequencies)
            rows[start : start + at_once, :, 0], rows[start : start + at_once, :, 1] = here.real, here.imag
        return LinePricing(frequencies, indices, self.samples, rows, subject.slices)

    def reference(
        self, model: Model, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> tuple[Batch, ...]:
        """The same energy on lines all over the band, at every point."""
        frequencies = self._lines(band, sample_time)[1]
        return (response_batch(model, points, frequencies[:: 1 + len(frequencies) // MOST_REFERENCE]),)

    def _lines(self, band: tuple[float, float] | None, sample_time: float) -> tuple[IntArray, FloatArray]:
        indices = np.arange(0 if self.constant else 1, self.samples // 2 + 1)
        line_spacing = 2 * np.pi / (self.samples * sample_time)
        if band is not None:
            slack = 1e-9 * len(indices)
            indices = indices[(indices >= band[0] / line_spacing - slack) & (indices <= band[1] / line_spacing + slack)]
        if len(indices) == 0:
            raise RangeError("no line of the record lies in the frequency band; widen it or use more samples", "band")
        return indices, np.asarray(indices * line_spacing, dtype=np.float64)

    @classmethod
    def example(cls) -> "LineSpectra":
        """A small one, for the conformance tests."""
        return cls(samples=64)


@dataclass(frozen=True, eq=False)
class LinePricing:
    """The lines at M points: `rows` (M, F, 2, k), Re a and Im a; products count within each of the `parts` of k alone.

    `use` (L, M, F): what energy on each line takes of each limit, infinite where it must not be. A block's only
    shape holds the number of its line.
    """

    frequencies: FloatArray
    indices: IntArray
    samples: int
    rows: FloatArray
    parts: tuple[slice, ...]
    use: FloatArray | None = None

    @property
    def places(self) -> IntArray:
        """One local experiment an operating point."""
        return np.arange(len(self.rows))

    def limits(self, caps: FloatArray, samples: int) -> FloatArray:
        """The caps; energy is spread over whatever time there is."""
        return caps

    def within(self, caps: FloatArray, samples: int) -> "LinePricing":
        """All experiments; each may have as little energy as it is given."""
        return self

    def restricted(self, share: Use) -> "LinePricing":
        """With what the limits charge on every line; lines that must not be used tell nothing."""
        use = share(self.frequencies)
        closed = np.any(np.isinf(use), axis=0)
        if closed.all():
            raise RangeError("the forbidden bands leave no line at any operating point", "limits")
        return replace(self, use=use, rows=np.where(closed[:, :, None, None], 0.0, self.rows))

    def flat(self) -> list[Block]:
        """Equal energy on all lines, as a block without a line of its own, where there is a line."""
        return [self._flat(m) for m in range(len(self.rows)) if self._open(m).any()]

    def best(
        self,
        prices: FloatArray,
        charges: FloatArray,
        blocks: Sequence[Block],
        weights: Sequence[FloatArray],
        tolls: FloatArray | None = None,
    ) -> Offer:
        """a* Z a on all lines; offered are the highest peaks that are worth their charge, and the lines in use."""
        worth = self._worth(prices)
        if tolls is not None and self.use is not None:
            closed = np.any(np.isinf(self.use), axis=0)
            charged = np.einsum("lm,lmf->mf", tolls, np.where(closed, 0.0, self.use))
            worth = np.where(closed, 0.0, worth - charged)
        highest = worth.max(axis=1)
        padded = np.pad(worth, [(0, 0), (1, 1)], constant_values=-np.inf)
        peak = (worth >= padded[:, :-2]) & (worth >= padded[:, 2:])
        offered = peak & (worth >= np.maximum(NEARLY * charges, 0.9 * highest)[:, None])
        in_use = [block for block, weight in zip(blocks, weights, strict=True) if weight[0, 0] > 1e-9]
        known = {(block.point, int(block.shapes[0, 0])) for block in in_use}
        best = foremost(offered.ravel(), (worth - charges[:, None]).ravel())
        new = [divmod(index, worth.shape[1]) for index in best.tolist()]
        new_blocks = [self._block(m, f) for m, f in new if (m, f) not in known]
        return Offer(highest, in_use + new_blocks)

    def transformed(self, basis: FloatArray, taken: float = 1.0) -> "LinePricing":
        """The same for the parameters basis⁻¹ θ_G."""
        places = [np.flatnonzero(np.any(basis[part] != 0, axis=0)) for part in self.parts]
        parts = tuple(slice(int(place[0]), int(place[-1]) + 1) if len(place) else slice(0, 0) for place in places)
        flat = self.rows.reshape(-1, self.rows.shape[-1]) @ basis
        use = None if self.use is None else taken * self.use
        return replace(self, rows=flat.reshape(*self.rows.shape[:-1], -1), parts=parts, use=use)

    def spectrum(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> LineSpectrum:
        """The lines of blocks of one point, in the order of frequency."""
        energies = np.zeros(len(self.frequencies))
        for block, weight in zip(blocks, weights, strict=True):
            line = int(block.shapes[0, 0])
            lines = np.flatnonzero(self._open(block.point)) if line < 0 else [line]
            energies[lines] += weight[0, 0] / len(lines)
        used = energies > 0
        return LineSpectrum(self.frequencies[used], energies[used], self.indices[used], self.samples)

    def _worth(self, prices: FloatArray) -> FloatArray:
        """a* Z a (M, F), by products with the root of Z, which has few columns where few directions bind."""
        points, lines, _, k = self.rows.shape
        roots = [root(prices[part, part]) for part in self.parts]
        at_once = max(1, SENSITIVITIES_AT_ONCE // (2 * lines * max(k, 1)))
        worth = np.zeros((points, lines))
        for start in range(0, points, at_once):
            here = self.rows[start : start + at_once]
            for part, factor in zip(self.parts, roots, strict=True):
                seen = here[..., part].reshape(-1, factor.shape[0]) @ factor
                worth[start : start + at_once] += np.einsum("nr,nr->n", seen, seen).reshape(len(here), lines, 2).sum(-1)
        return worth

    def _flat(self, point: int) -> Block:
        lines = self._open(point)
        rows = self.rows[point, lines].reshape(-1, self.rows.shape[-1]) / np.sqrt(np.count_nonzero(lines))
        use = None if self.use is None else self.use[:, point, lines].mean(axis=-1)[:, None, None]
        return Block(int(point), np.full((1, 1), -1.0), self._information(rows), self.parts, use=use)

    def _open(self, point: int) -> BoolArray:
        """The lines (F,) that may be used."""
        if self.use is None:
            return np.ones(len(self.frequencies), dtype=np.bool_)
        return np.asarray(np.all(np.isfinite(self.use[:, point]), axis=0))

    def _block(self, point: int, line: int) -> Block:
        rows = self.rows[point, line]
        use = None if self.use is None else self.use[:, point, line][:, None, None]
        return Block(int(point), np.full((1, 1), float(line)), self._information(rows), self.parts, rows.T, use)

    def _information(self, rows: FloatArray) -> FloatArray:
        """(1, 1, k, k)"""
        information = np.zeros((1, 1, rows.shape[1], rows.shape[1]))
        for part in self.parts:
            information[0, 0, part, part] = rows[:, part].T @ rows[:, part]
        return information
