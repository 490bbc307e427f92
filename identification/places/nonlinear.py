"""Effects that act on signals: at the actuator, in feedback around the plant, at the sensor, added to the output."""

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.places.aliases import aliases
from identification.places.intersample import OFFSETS
from identification.places.motion import motions, powers
from identification.places.place import Effect, Flow, FurtherParameter

SLOPE_STEP, CHANGE = 1e-4, 1e-6


@dataclass(frozen=True)
class Actuator(Effect):
    """The plant is driven by g(u) = u + e s(u)."""

    place: ClassVar[str] = "actuator"
    needs_records: ClassVar[bool] = True

    @abstractmethod
    def shape(self, u: FloatArray) -> FloatArray:
        """s(u) (M, L) over one period."""

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K)."""
        finer = 1 if flow.held else flow.finer(self)
        change = flow.batch.spectrum(self.shape(flow.input_signal(finer)))
        return flow.through(flow.entry * change)[None]


@dataclass(frozen=True)
class Feedback(Effect):
    """A force that depends on the displacement q and the flow q̇ of the plant, wherever the sensor sits.

        x = G (u − e f(q, q̇)),   q = s^(−d) x,   d = `order` of the output: 0 displacement, 1 flow, 2 rate of the flow
        x = G u + e f(q, q̇),   q = s^(−d) u,   where the motion is `driven`: the input is the motion, the output a force

    `on_displacement`: the force depends on q, else on q̇; `differentiated`: f is a flux and the force is its rate.
    `remembers`: the force depends on what was before; `at_once`: it depends on one moment only.
    `curve`: a name that effects share whose f is the same function, of the displacement in one and the flow in another.
    """

    place: ClassVar[str] = "feedback from output or velocity"
    needs_records: ClassVar[bool] = True
    on_displacement: ClassVar[bool] = True
    differentiated: ClassVar[bool] = False
    remembers: ClassVar[bool] = False
    at_once: ClassVar[bool] = True
    curve: ClassVar[str] = ""

    order: int = 0
    driven: bool = False

    @abstractmethod
    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """f(q, q̇) (M, L) over one period."""

    def rounded(self, width: float) -> Self:
        """With its corners rounded off over this share of the motion, where it has any, to be sharpened again."""
        return self

    def slopes(self, x: FloatArray, velocity: FloatArray) -> tuple[FloatArray, FloatArray]:
        """∂f/∂q and ∂f/∂q̇ (M, L) at each time, by central differences of the one that f depends on."""
        by = x if self.on_displacement else velocity
        step = SLOPE_STEP * np.sqrt(np.mean(by**2, axis=-1, keepdims=True)) + np.finfo(np.float64).tiny
        up, down = (self.force(by + side * step, by + side * step) for side in (1, -1))
        slope, none = np.asarray((up - down) / (2 * step)), np.zeros_like(by)
        return (slope, none) if self.on_displacement else (none, slope)

    def changed(self, x: FloatArray, velocity: FloatArray, by_x: FloatArray, by_velocity: FloatArray) -> FloatArray:
        """The change of f (M, L) with small changes of q and q̇ (M, L), by differences: for what is not `at_once`."""
        motion, by = (x, by_x) if self.on_displacement else (velocity, by_velocity)
        size = np.sqrt(np.mean(motion**2, axis=-1, keepdims=True)) + np.finfo(np.float64).tiny
        step = CHANGE * size / (abs(by).max(axis=-1, keepdims=True) + np.finfo(np.float64).tiny)
        up, down = (self.force(x + side * step * by_x, velocity + side * step * by_velocity) for side in (1, -1))
        return np.asarray((up - down) / (2 * step))

    def held_against(self, q: FloatArray, flow: FloatArray, e: FloatArray, by: FloatArray) -> FloatArray:
        """e f (M,) at one instant for q, q̇ (M,) without it, of which it takes `by` (2, M) for each of its units."""
        first = e * self.force(q[:, None], flow[:, None])[:, 0]
        second: FloatArray = e * self.force((q - by[0] * first)[:, None], (flow - by[1] * first)[:, None])[:, 0]
        return second

    def lines(self, batch: Batch, x: FloatArray, velocity: FloatArray, held: int = 1) -> ComplexArray:
        """F (M, K) of the force for q and q̇ (M, L) over one period; its means over `held` values where it is held."""
        values = self.force(x, velocity)
        kept = values if held == 1 else values.reshape(len(values), -1, held).mean(axis=-1)
        return np.asarray(self.rates(batch) * batch.spectrum(kept))

    def rates(self, batch: Batch) -> ComplexArray:
        """What turns lines of f into lines of the force, (K,)."""
        return powers(batch, int(self.differentiated))

    def seen_by(self, batch: Batch) -> list[Self]:
        """The effect as it acts on the motion of these channels; of every order where quantities are not stated."""
        return [replace(self, order=order, driven=driven) for order, driven in motions(batch.channels)]

    @property
    def seen_as(self) -> tuple[str, int, bool]:
        """What the signals tell of the effect: the function and how often the carrier is differentiated before it."""
        return self.curve or self.kind, int(not self.on_displacement) - self.order, self.driven

    def variants(self, flow: Flow) -> list[Self]:
        """The grid of further parameters for every motion that the signals may be."""
        return [one for placed in self.seen_by(flow.batch) for one in placed.shaped(flow)]

    def shaped(self, flow: Flow) -> list[Self]:
        """The effect over the grid of its further parameters, its motion kept."""
        return super().variants(flow)

    def scaled(self, parameter: FurtherParameter, flow: Flow, relative: float) -> float:
        """The absolute value of a further parameter; displacement and flow are those of its own motion."""
        return flow.scale(parameter.quantity, relative, self.order, self.driven)

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K)."""
        held = OFFSETS if flow.between is not None and self.order == 0 and not self.driven else 1
        motion, batch = flow.motion(self.order, self.driven, flow.finer(self)), flow.batch
        change = self.lines(batch, *motion, held)
        if self.driven:
            return np.asarray((flow.factor * change)[None])
        if flow.between is not None or not batch.repeats:
            return flow.through(-flow.response * change)[None]
        structure, zeta = flow.setting.structure, flow.setting.zeta
        beyond = aliases(self.force(*motion), self.differentiated, structure, zeta, batch)
        return (flow.through(-flow.response * change) + beyond)[None]


@dataclass(frozen=True)
class Sensor(Effect):
    """The sensor shows h(y) = y + e s(y)."""

    place: ClassVar[str] = "sensor"
    needs_records: ClassVar[bool] = True

    @abstractmethod
    def shape(self, y: FloatArray) -> FloatArray:
        """s(y) (M, L) over one period."""

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K)."""
        return flow.batch.spectrum(self.shape(flow.linear_signal))[None]


@dataclass(frozen=True)
class Added(Effect):
    """A signal added to the output: y + Σ e_i d_i(t)."""

    place: ClassVar[str] = "added to the output"
    needs_records: ClassVar[bool] = True

    @abstractmethod
    def signal(self, time: FloatArray) -> FloatArray:
        """d_i(t) (shapes, L) over one period, for `time` (L,) running from 0 to 1 within it."""

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (shapes, M, K)."""
        return np.repeat(self.lines(flow.batch)[:, None, :], len(flow.batch.points), axis=1)

    def lines(self, batch: Batch) -> ComplexArray:
        """The lines of the signals, (shapes, K)."""
        assert batch.signals is not None
        length = batch.signals.shape[1]
        return batch.spectrum(self.signal(np.arange(length) / length))
