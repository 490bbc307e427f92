"""What every physical effect says of itself, and what it is told of the experiment it is judged in."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import ClassVar, Literal, Protocol, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray, IntArray
from identification.comparison.batch import Batch
from identification.models.hold import hold_factor
from identification.models.structure import Structure
from identification.places.intersample import Between
from identification.places.motion import displacement, flow_rate
from identification.signals import HeldInput

Quantity = Literal["frequency", "time", "input", "output", "displacement", "flow", "number"]


class Reaction(Protocol):
    """What forces make of a change (M, K) of the core; `x`: the unknowns of the steady state that it belongs to."""

    @property
    def x(self) -> ComplexArray:
        """As the loop of the forces has them."""

    @property
    def stable(self) -> bool:
        """Whether the steady state is one that small changes lead back to."""

    def __call__(self, change: ComplexArray) -> ComplexArray:
        """The change with the reaction of the forces."""


@dataclass(frozen=True)
class FurtherParameter:
    """A parameter of an effect besides its amplitude, found by a scan and then by the refit.

    `values` are relative to what the experiment offers: for a frequency 0 … 1 runs logarithmically from half the lowest
    to twice the highest excited frequency, a time is its inverse; levels are relative to the largest input, output,
    displacement or flow; a number is absolute. `fitted`: False when only scanned. `lowest`, `highest`: the range of a
    number or level, in the same measure; frequencies and times are kept where the excited band, widened fourfold to
    each side, can show them.
    """

    name: str
    quantity: Quantity
    values: tuple[float, ...]
    fitted: bool = True
    lowest: float = 0.0
    highest: float = np.inf


@dataclass(frozen=True, eq=False)
class Setting:
    """What the parameters give at the operating points of a batch.

    `zeta` (M, n); `points` (M, s) scaled to −1 … 1 over the range of the scheduling variables; `zeta_slope`
    (M, n_plant, s): ∂ζ_G by the scaled scheduling variables; `passed` (M, n_plant): ∂ζ_G by what T(p) θ gives, where
    effects divide it, None: one; `channels` (M, 2): output and input of each row, None: the only ones.
    """

    structure: Structure
    zeta: FloatArray
    points: FloatArray
    zeta_slope: FloatArray
    passed: FloatArray | None = None
    channels: IntArray | None = None


@dataclass(frozen=True, eq=False)
class Flow:
    """The signals of a batch as the model now explains them: what signatures are computed from.

    `setting.zeta` includes what effects change of it; `response` (M, K) of the plant core, `entry` (M, K) that as the
    input is seen through its hold; `entering` (M, K) the input behind the actuator; `drive` U (M, K) what enters the
    core, forces fed back included; `core` X (M, K) what leaves it; `factored` (M, K) that and the modes beside it,
    times all factors; `linear` (M, K) after all that acts linearly; `output` (M, K). `acting`: the effects with their
    amplitudes; `gradient`: of the core by ζ_G (M, n_plant, K), with True as the input is seen. `mean` (M,) of the
    displacement where the output does not show it; `closing` turns a change of X without the reaction of the forces
    (M, K) into one with it; `between`: the motion between the samples, where the plant is followed there; `shown`
    (M, K) what the sensor shows, of which the `recorder` makes the output, None: as it is.
    """

    batch: Batch
    setting: Setting
    response: ComplexArray
    entry: ComplexArray
    entering: ComplexArray
    drive: ComplexArray
    core: ComplexArray
    factored: ComplexArray
    linear: ComplexArray
    output: ComplexArray
    factor: ComplexArray
    acting: "tuple[tuple[Effect, FloatArray], ...]"
    gradient: Callable[[bool], ComplexArray]
    mean: FloatArray
    closing: Reaction | None = None
    between: Between | None = None
    shown: ComplexArray | None = None
    recorder: Callable[[ComplexArray], ComplexArray] | None = None
    cache: dict[tuple[str, int, int], FloatArray] = field(default_factory=dict)

    @cached_property
    def by_coefficients(self) -> ComplexArray:
        """∂`factored`/∂ζ_G (M, n_plant, K), ζ_G before effects divide it; that of modes beside the core left out."""
        gradient = self.gradient(False)
        if self.entry is self.response:
            changes = gradient * self.drive[:, None, :]
        else:
            seen = self.gradient(True) * self.entering[:, None, :]
            changes = seen + gradient * (self.drive - self.entering)[:, None, :]
        if self.closing is None:
            found = changes * self.factor[:, None, :]
        else:
            found = np.stack([self.through(one) for one in np.moveaxis(changes, 1, 0)], axis=1)
        return np.asarray(found if self.setting.passed is None else found * self.setting.passed[:, :, None])

    @property
    def held(self) -> HeldInput | None:
        """How the plant sees the input between its samples; None in discrete time."""
        return None if self.setting.structure.is_discrete else self.batch.held

    @cached_property
    def passing(self) -> ComplexArray:
        """What enters paths beside the core (M, K)."""
        return passing(self.drive, self.entering, self.batch.omega, self.held)

    @property
    def signals(self) -> FloatArray:
        """The input over one period, (M, L)."""
        assert self.batch.signals is not None
        return self.batch.signals

    def recorded(self, change: ComplexArray) -> ComplexArray:
        """A change of what the sensor shows (…, M, K) as it is recorded."""
        return change if self.recorder is None else self.recorder(change)

    def through(self, change: ComplexArray) -> ComplexArray:
        """A change of the core (M, K), with the reaction of the forces to it, as it leaves the path behind."""
        return np.asarray((change if self.closing is None else self.closing(change)) * self.factor)

    def finer(self, effect: "Effect") -> int:
        """By how much the time grid of a force is finer than the samples; not at all in discrete time."""
        return 1 if self.setting.structure.is_discrete else effect.oversampling

    def motion(self, order: int, driven: bool, finer: int) -> tuple[FloatArray, FloatArray]:
        """Displacement and flow (M, L·finer): from the output of this order, or from the input where that is driven."""
        if order == 0 and not driven and (self.between is not None or not self.batch.repeats):
            return self._own_motion(finer)
        carrier, mean = (self.batch.inputs, np.zeros(len(self.mean))) if driven else (self.core, self.mean)
        name = "input" if driven else "core"
        q = self._kept((f"q of {name}", order, finer), lambda: displacement(carrier, mean, self.batch, order))
        return q, self._kept((f"flow of {name}", order, finer), lambda: flow_rate(carrier, self.batch, order))

    def _own_motion(self, finer: int) -> tuple[FloatArray, FloatArray]:
        names = [(f"{what} as it is followed", 0, finer) for what in ("q", "flow")]
        if names[0] not in self.cache:
            ends = self.batch.signal(self.core, finer), self.batch.rate(self.core, finer)
            found = ends if self.between is None else self.between(self.core, self.drive)
            self.cache.update(zip(names, found, strict=True))
        return self.cache[names[0]], self.cache[names[1]]

    def input_signal(self, finer: int = 1) -> FloatArray:
        """The input over one period, (M, L·finer)."""
        return self._kept(("u", 0, finer), lambda: self.batch.inputs)

    def _kept(self, name: tuple[str, int, int], lines: Callable[[], ComplexArray]) -> FloatArray:
        if name not in self.cache:
            self.cache[name] = self.batch.signal(lines(), name[-1])
        return self.cache[name]

    @cached_property
    def linear_signal(self) -> FloatArray:
        """What reaches the sensor, (M, L)."""
        return self.batch.signal(self.linear)

    def scale(self, quantity: Quantity, relative: float, order: int = 0, driven: bool = False) -> float:
        """The absolute value of a further parameter whose relative value is given."""
        if quantity in ("frequency", "time"):
            low, high = self.batch.band
            frequency = 0.5 * low * (4 * high / low) ** relative
            return float(frequency if quantity == "frequency" else 1 / frequency)
        if quantity == "number" or self.batch.signals is None:
            return relative
        if quantity in ("displacement", "flow"):
            signal = self.motion(order, driven, 1)[quantity == "flow"]
        else:
            signal = self.signals if quantity == "input" else self.linear_signal
        return float(relative * abs(signal).max())


def passing(drive: ComplexArray, entering: ComplexArray, omega: FloatArray, held: HeldInput | None) -> ComplexArray:
    """What enters paths beside the core (M, K): the drive, its input as smooth as the hold makes it."""
    return drive if held is None else np.asarray(drive + entering * (hold_factor(omega, held) - 1))


@dataclass(frozen=True)
class Effect(ABC):
    """A physical effect with amplitude e; with e = 0 it does nothing. The fields are its further parameters.

    `domain`: the kind of plant it belongs to; `unit` of e in words, `sign` +1 where only e ≥ 0 is physical, `largest`
    the largest physical |e| (None: no bound), `source` where it is described; `of_measurements`: it lies in how or when
    was measured, not in the plant; `oversampling` of the time grid on which a force is computed in continuous time;
    `points_needed`: distinct values of each scheduling variable without which it
    is a lower order under another name; `states` by how many it raises the order of the plant, infinite for distributed
    effects such as a delay or diffusion; `refines` the kind that it contains, which is kept to where it leaves nothing
    material; `unseen` says why an experiment does not show it where its signature
    vanishes, `unjudged` why it was not looked for where it is not `judgeable`.
    """

    kind: ClassVar[str]
    title: ClassVar[str]
    place: ClassVar[str]
    unit: ClassVar[str]
    source: ClassVar[str]
    domain: ClassVar[str] = "general"
    sign: ClassVar[int] = 0
    largest: ClassVar[float | None] = None
    needs_records: ClassVar[bool] = False
    of_measurements: ClassVar[bool] = False
    points_needed: ClassVar[int] = 1
    oversampling: ClassVar[int] = 2
    states: ClassVar[float] = 0
    refines: ClassVar[str] = ""
    unjudged: ClassVar[str] = ""
    unseen: ClassVar[str] = "invisible in this experiment: the fitted parameters take up all that it changes"
    parameters: ClassVar[tuple[FurtherParameter, ...]] = ()

    @classmethod
    def example(cls) -> Self:
        """An instance for tests and catalogues."""
        return cls()

    @property
    def shapes(self) -> int:
        """The number of amplitudes."""
        return 1

    @abstractmethod
    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (shapes, M, K) at the amplitude e (shapes, M)."""

    def composed(self, e: FloatArray) -> "tuple[Effect, FloatArray]":
        """The effect of one shape, with its amplitude (1, M), that this one is at the amplitude e (shapes, M)."""
        return self, e

    def precision(self) -> FloatArray:
        """1/variance (shapes,) of the amplitudes before anything is measured: nought unless they are penalised."""
        return np.zeros(self.shapes)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """How the amplitude is spread over the measurements of a batch, (M,): one everywhere unless overridden."""
        return np.ones(len(batch.points))

    def dead_time(self, e: FloatArray) -> FloatArray:
        """The seconds (M,) by which all passes later at the amplitude e (shapes, M)."""
        return np.zeros(e.shape[-1])

    def describe(self) -> str:
        """What it is of, in words, where its title does not say it."""
        return ""

    def judgeable(self, flow: Flow) -> bool:
        """Whether the data of this batch can show the effect at all."""
        return not self.needs_records or flow.batch.signals is not None

    def variants(self, flow: Flow) -> list[Self]:
        """The effect over the grid of its further parameters; itself alone when there are none."""
        names = [parameter.name for parameter in self.parameters]
        grids = [[self.scaled(p, flow, value) for value in p.values] for p in self.parameters]
        return [dataclasses.replace(self, **dict(zip(names, values, strict=True))) for values in product(*grids)]

    def variants_over(self, flows: Sequence[Flow]) -> list[Self]:
        """The variants for several batches: those of the first where further parameters make a grid, else of all."""
        if self.parameters:
            return self.variants(flows[0])
        return list(dict.fromkeys(one for flow in flows for one in self.variants(flow)))

    def freer(self, points: FloatArray) -> list[Self]:
        """With one further parameter let go that was fixed, to be tried from where the effect was fitted."""
        return []

    def scan(self, flows: Sequence[Flow]) -> list[tuple[Self, float]]:
        """Variants with amplitudes that are not small, to begin a refit with; none where small ones lead there."""
        return []

    def scaled(self, parameter: FurtherParameter, flow: Flow, relative: float) -> float:
        """The absolute value of a further parameter whose relative value is given."""
        return flow.scale(parameter.quantity, relative)

    def looked_at(self, flow: Flow) -> int:
        """How many variants the data were searched for, where that is more than `variants` gives."""
        return 1

    def at(self, points: FloatArray) -> list[Self]:
        """The effect at each of the scaled operating points (M, s), or one that is the same at all of them."""
        return [self]

    def fixed(self, parameter: FurtherParameter) -> bool:
        """Whether a further parameter is left as it is by a refit."""
        return not parameter.fitted

    def fitted_names(self) -> tuple[str, ...]:
        """Further parameters that a refit adjusts."""
        return tuple(parameter.name for parameter in self.parameters if not self.fixed(parameter))

    def values(self) -> FloatArray:
        """The values of the fitted further parameters."""
        return np.array([getattr(self, name) for name in self.fitted_names()], dtype=np.float64)

    def limits(self, flow: Flow) -> tuple[FloatArray, FloatArray]:
        """The physical range of the fitted further parameters."""
        ranges = [self._range(parameter, flow) for parameter in self.parameters if not self.fixed(parameter)]
        low, high = np.array(ranges, dtype=np.float64).reshape(-1, 2).T
        return low, high

    def _range(self, parameter: FurtherParameter, flow: Flow) -> tuple[float, float]:
        if parameter.quantity in ("frequency", "time"):
            ends = [self.scaled(parameter, flow, relative) for relative in (0.0, 1.0)]
            return min(ends) / 2, max(ends) * 2
        low, high = (self.scaled(parameter, flow, end) for end in (parameter.lowest, parameter.highest))
        return low, high

    def with_values(self, values: FloatArray) -> Self:
        """The same effect with other values of the fitted further parameters."""
        return dataclasses.replace(self, **dict(zip(self.fitted_names(), map(float, values), strict=True)))
