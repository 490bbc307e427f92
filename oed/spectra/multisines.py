"""Candidate multisines: finitely many signals to choose from, of which whole periods are played."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.comparison.batch import EVEN, EXCITED, ODD, Batch
from identification.errors import RangeError
from identification.models.model import Model
from identification.places.steady import NoSteadyStateError
from oed.hypothesis import noise_variances
from oed.spectra.family import NEARLY, Block, Offer, Use, foremost
from oed.subject import Subject

MOST_CANDIDATES = 20_000
MOST_SAMPLES = 2**23
LEAST_PERIODS = 2
PARTS = (1, 2, 4, 8)


@dataclass(frozen=True, eq=False)
class MultisineSpectrum:
    """A multisine u(t) = Re Σ_i A_i e^{j 2π k_i t/L}, played `periods` times at exactly this level.

    `indices` k (K,), `phasors` A (K,) complex, `samples` L of a period, `frequencies` (K,) in rad/s.
    """

    frequencies: FloatArray
    indices: IntArray
    phasors: ComplexArray
    samples: int
    periods: int

    @property
    def period_energies(self) -> FloatArray:
        """Σ_t u(t)² over one period, of each line (K,)."""
        return np.asarray(self.samples / 2 * abs(self.phasors) ** 2)

    @property
    def level(self) -> float:
        """Root mean square of the signal."""
        return float(np.sqrt(np.sum(abs(self.phasors) ** 2) / 2))

    @property
    def energy(self) -> float:
        """Σ_t u(t)² over all periods."""
        return float(self.periods * self.period_energies.sum())

    def line_energies(self, samples: int, sample_time: float) -> tuple[IntArray, FloatArray]:
        """The lines with their energies over all periods; raises RangeError for another period than that designed."""
        if samples != self.samples:
            raise RangeError(f"these signals were designed with a period of {self.samples} samples", "samples")
        return self.indices, self.periods * self.period_energies

    def period(self) -> FloatArray:
        """One period of the signal, (L,)."""
        lines = np.zeros(self.samples // 2 + 1, dtype=np.complex128)
        lines[self.indices] = self.phasors
        return np.asarray(np.fft.irfft(lines * self.samples / 2, n=self.samples))


@dataclass(frozen=True)
class Multisines:
    """Random-phase multisines of given levels in given bands, every one of them a candidate at every operating point.

    What an effect on signals shows depends on the level, and on the lines that are left out; so the signals themselves
    are chosen from, and of each a number of whole periods, at most as many as the samples of a local experiment hold.
    """

    kind: ClassVar[str] = "multisines"

    samples: Annotated[int, "samples of a period"]
    levels: Annotated[tuple[float, ...], "root mean squares of the input to choose from, in its unit"]
    bands: Annotated[
        tuple[tuple[float, float], ...],
        "bands to choose from, rad/s; none: the whole band, its halves, quarters, eighths",
    ] = ()
    share: Annotated[float, "share of the lines of a band that is excited; the others show what is nonlinear"] = 0.75
    draws: Annotated[int, "sets of lines and phases to choose from"] = 1
    seed: Annotated[int, "of lines and phases"] = 0

    def __post_init__(self) -> None:
        if self.samples < 8:
            raise RangeError(f"a period of {self.samples} samples has too few lines; use at least 8", "samples")
        if not self.levels or not all(np.isfinite(level) and level > 0 for level in self.levels):
            raise RangeError("give at least one level, all of them positive", "levels")
        if not 0 < self.share <= 1:
            raise RangeError(f"the share of excited lines is {self.share}; it must lie between 0 and 1", "share")
        if not 1 <= self.draws <= 100:
            raise RangeError(f"{self.draws} sets of phases are asked for; choose from 1 to 100", "draws")
        if self.seed < 0:
            raise RangeError("the seed must be zero or more", "seed")
        if any(not 0 <= low < high for low, high in self.bands):
            raise RangeError("every band must rise, from zero or more", "bands")

    def pricing(
        self, subject: Subject, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> "MultisinePricing":
        """Simulate every candidate at the operating points (M, s) that has a steady state there."""
        p = subject.model.dependence.points(points)
        self._check_size(len(p))
        signals = self.signals(band, sample_time)
        information, steady = _informations(subject, p, signals, sample_time)
        places = np.repeat(np.arange(len(p)), len(signals)).reshape(len(p), -1)[steady]
        numbers = np.tile(np.arange(len(signals)), (len(p), 1))[steady]
        energies = np.array([one.energy for one in signals])[numbers]
        per_energy = information[steady] / energies[:, None, None]
        return MultisinePricing(tuple(signals), numbers, places, energies, per_energy)

    def reference(
        self, model: Model, points: ArrayLike, band: tuple[float, float] | None, sample_time: float
    ) -> tuple[Batch, ...]:
        """The signals over the whole band at the middle level, one period each, at every point."""
        self._check_size(len(model.dependence.points(points)))
        signals = self.signals(band, sample_time)
        level = sorted(self.levels)[len(self.levels) // 2]
        own = [one for one in signals if abs(one.level / level - 1) < 1e-9] or signals
        widest = max(own, key=lambda one: len(one.indices))
        return (record_batch(model, model.dependence.points(points), widest, sample_time),)

    def signals(self, band: tuple[float, float] | None, sample_time: float) -> list[MultisineSpectrum]:
        """Every draw in every band at every level, the lowest level first."""
        spacing = 2 * np.pi / (self.samples * sample_time)
        generators = np.random.default_rng(self.seed).spawn(self.draws)
        shapes = [
            (lines, phasors)
            for generator in generators
            for low, high in self._bands(band or (spacing, np.pi / sample_time))
            for lines, phasors in [self._drawn(low / spacing, high / spacing, generator)]
            if len(lines)
        ]
        if not shapes:
            raise RangeError("no line of a period lies in one of the bands; widen them or use more samples", "band")
        return [
            MultisineSpectrum(np.asarray(lines * spacing, dtype=np.float64), lines, level * phasors, self.samples, 1)
            for level, (lines, phasors) in product(sorted(self.levels), shapes)
        ]

    def _bands(self, whole: tuple[float, float]) -> list[tuple[float, float]]:
        """The bands to choose from, as far as they lie in the whole one."""
        return [(max(low, whole[0]), min(high, whole[1])) for low, high in self.bands or _parts(whole)]

    def _check_size(self, points: int) -> None:
        signals = self.draws * len(self.levels) * (len(self.bands) or sum(PARTS))
        if points * signals > MOST_CANDIDATES:
            raise RangeError(
                f"{signals} signals at {points} operating points are more than {MOST_CANDIDATES} candidates; give fewer"
                " levels, bands, draws or operating points",
                "operating_points",
            )
        if max(points, signals) * self.samples > MOST_SAMPLES:
            raise RangeError(
                f"periods of {self.samples} samples are too long for {points} operating points and {signals} signals;"
                " give shorter periods or fewer of them",
                "samples",
            )

    def _drawn(self, low: float, high: float, generator: np.random.Generator) -> tuple[IntArray, ComplexArray]:
        """Lines between two ends, and phasors of random phase whose root mean square is one."""
        slack = 1e-9 * self.samples
        lines = np.arange(1, (self.samples - 1) // 2 + 1)
        lines = lines[(lines >= low - slack) & (lines <= high + slack)]
        count = int(np.ceil(self.share * len(lines)))
        chosen = np.sort(generator.choice(lines, count, replace=False)) if count else lines
        phases = generator.uniform(0, 2 * np.pi, count)
        return chosen.astype(np.int64), np.asarray(np.sqrt(2 / max(count, 1)) * np.exp(1j * phases))

    @classmethod
    def example(cls) -> "Multisines":
        """A small one, for the conformance tests."""
        return cls(samples=64, levels=(1.0, 4.0))


def _parts(band: tuple[float, float]) -> list[tuple[float, float]]:
    """A band, its halves, quarters and eighths."""
    low, high = band
    ends = [np.linspace(low, high, count + 1) for count in PARTS]
    return [(float(a), float(b)) for edges in ends for a, b in pairwise(edges)]


def record_batch(model: Model, points: FloatArray, signal: MultisineSpectrum, sample_time: float) -> Batch:
    """One period of a multisine at each operating point (M, s), compared at all lines of the period, outputs zero."""
    period = signal.period()
    lines = np.fft.rfft(period) / signal.samples
    count = len(lines)
    classes = np.where(np.arange(count) % 2 == 1, ODD, EVEN)
    classes[signal.indices] = EXCITED
    shape = (len(points), count)
    batch = Batch(
        points=points,
        omega=np.asarray(2 * np.pi * np.fft.rfftfreq(signal.samples, sample_time)),
        inputs=np.broadcast_to(lines, shape),
        outputs=np.zeros(shape, dtype=np.complex128),
        variances=np.ones(shape),
        classes=np.broadcast_to(classes, shape),
        members=np.arange(len(points)),
        signals=np.broadcast_to(period, (len(points), signal.samples)),
        sample_time=sample_time,
    )
    return replace(batch, variances=noise_variances(model, batch, signal.samples))


def _informations(
    subject: Subject, points: FloatArray, signals: Sequence[MultisineSpectrum], sample_time: float
) -> tuple[FloatArray, BoolArray]:
    """The information of one period (M, C, k, k), and which candidates (M, C) have a steady state."""
    information = np.zeros((len(points), len(signals), subject.size, subject.size))
    steady = np.ones((len(points), len(signals)), dtype=np.bool_)
    for c, signal in enumerate(signals):
        try:
            information[:, c] = subject.by_record(record_batch(subject.model, points, signal, sample_time))
        except NoSteadyStateError:
            for m in range(len(points)):
                try:
                    batch = record_batch(subject.model, points[m : m + 1], signal, sample_time)
                    information[m, c] = subject.by_record(batch)[0]
                except NoSteadyStateError:
                    steady[m, c] = False
    if not steady.any():
        raise NoSteadyStateError(
            "the model has no steady state for any of the candidate signals; choose lower levels", "levels"
        )
    return information, steady & (np.trace(information, axis1=2, axis2=3) > 0)


@dataclass(frozen=True, eq=False)
class MultisinePricing:
    """C candidate experiments: `numbers` (C,) of their signals, `places` (C,) of their operating points.

    `energies` (C,) of one period; `information` (C, k, k) per unit of energy. Every candidate is a local experiment of
    its own; a block's only shape holds nothing.
    """

    signals: tuple[MultisineSpectrum, ...]
    numbers: IntArray
    places: IntArray
    energies: FloatArray
    information: FloatArray

    def flat(self) -> list[Block]:
        """Every candidate."""
        return [self.block(c) for c in range(len(self.energies))]

    def limits(self, caps: FloatArray, samples: int) -> FloatArray:
        """The energy (C,) of the most whole periods that the caps (M,) and the length of an experiment allow."""
        most = np.minimum(caps[self.places] / self.energies, samples // self.signals[0].samples)
        return np.asarray(np.floor(most * (1 + 1e-9)) * self.energies)

    def within(self, caps: FloatArray, samples: int) -> "MultisinePricing":
        """The candidates of which two periods can be played; raises RangeError when there is none."""
        kept = np.flatnonzero(self.limits(caps, samples) >= LEAST_PERIODS * self.energies * (1 - 1e-9))
        if len(kept) == 0:
            raise RangeError(
                f"not even {LEAST_PERIODS} periods of any candidate keep to the samples and caps; allow more, or lower"
                " levels",
                "samples",
            )
        per_candidate = (self.numbers[kept], self.places[kept], self.energies[kept], self.information[kept])
        return MultisinePricing(self.signals, *per_candidate)

    def restricted(self, share: Use) -> "MultisinePricing":
        """The candidates that keep all limits at their level; raises RangeError when there is none."""
        omega = np.asarray(np.unique(np.concatenate([one.frequencies for one in self.signals])), dtype=np.float64)
        shares = share(omega)
        squares = np.zeros((len(self.signals), len(omega)))
        for square, signal in zip(squares, self.signals, strict=True):
            square[np.searchsorted(omega, signal.frequencies)] = abs(signal.phasors) ** 2 / 2
        kept = [
            c
            for c, (m, n) in enumerate(zip(self.places.tolist(), self.numbers.tolist(), strict=True))
            if np.all(shares[:, m][:, squares[n] > 0] @ squares[n][squares[n] > 0] <= 1 + 1e-9)
        ]
        if not kept:
            raise RangeError(
                "no candidate keeps to the limits of the plant; choose lower levels or other bands", "limits"
            )
        per_candidate = (self.numbers[kept], self.places[kept], self.energies[kept], self.information[kept])
        return MultisinePricing(self.signals, *per_candidate)

    def best(
        self,
        prices: FloatArray,
        charges: FloatArray,
        blocks: Sequence[Block],
        weights: Sequence[FloatArray],
        tolls: FloatArray | None = None,
    ) -> Offer:
        """tr(Z I) of all candidates; offered are those that are worth their charge, and those in use."""
        worth = np.einsum("cij,ij->c", self.information, prices)
        in_use = [block for block, weight in zip(blocks, weights, strict=True) if weight[0, 0] > 1e-9]
        known = {block.point for block in in_use}
        good = foremost(worth >= NEARLY * charges, worth - charges)
        return Offer(worth, in_use + [self.block(c) for c in good.tolist() if c not in known])

    def transformed(self, basis: FloatArray, taken: float = 1.0) -> "MultisinePricing":
        """The same for the parameters basis⁻¹ θ."""
        return replace(self, information=basis.T @ self.information @ basis)

    def counts(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FloatArray:
        """How many periods of every candidate the weights are, (C,)."""
        counts = np.zeros(len(self.energies))
        np.add.at(counts, [block.point for block in blocks], self.periods(blocks, weights))
        return counts

    def periods(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FloatArray:
        """How many periods of the candidates the weights are, (blocks,)."""
        pairs = zip(blocks, weights, strict=True)
        return np.array([float(weight[0, 0]) / self.energies[block.point] for block, weight in pairs])

    def spectrum(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> MultisineSpectrum:
        """The signal of a candidate, with as many whole periods as its weight needs."""
        count = float(self.periods(blocks, weights).sum())
        signal = self.signals[int(self.numbers[blocks[0].point])]
        return replace(signal, periods=int(np.ceil(count * (1 - 1e-9))))

    def block(self, candidate: int) -> Block:
        """A candidate by itself."""
        return Block(candidate, np.zeros((1, 1)), self.information[candidate][None, None])
