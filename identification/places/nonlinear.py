"""Effects that act on signals: at the actuator, in feedback around the plant, at the sensor, added to the output."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.places.place import Effect, Flow


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
        return np.asarray((flow.entry * flow.factor * change)[None])


@dataclass(frozen=True)
class Feedback(Effect):
    """A force fed back to the input: x = G (u − e f(x, ẋ))."""

    place: ClassVar[str] = "feedback from output or velocity"
    needs_records: ClassVar[bool] = True

    @abstractmethod
    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """f(x, ẋ) (M, L) over one period."""

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K), the loop around f not closed a second time."""
        finer = flow.finer(self)
        change = flow.batch.spectrum(self.force(flow.core_signal(finer), flow.core_velocity(finer)))
        return np.asarray((-flow.response * flow.factor * change)[None])


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
