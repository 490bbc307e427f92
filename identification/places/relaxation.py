"""Impedances in series that settle with one time constant."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.moving import RATIO, Moving
from identification.places.place import FurtherParameter

TIME = FurtherParameter("time", "time", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8))


@dataclass(frozen=True)
class Relaxation(Moving, Parallel):
    """Y = (G + e z(jωτ)) U, τ = `time`; `at_rest` is z(0), zero where z has a pole there."""

    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = float("inf")
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (TIME, RATIO)
    moves: ClassVar[str] = "time"
    at_rest: ClassVar[float] = 1.0

    time: float = 1.0

    @abstractmethod
    def impedance(self, s: ComplexArray) -> ComplexArray:
        """z(s) (K,) for s ≠ 0."""

    def shape(self, omega: FloatArray) -> ComplexArray:
        """z(jωτ) (K,)."""
        result = np.full(len(omega), self.at_rest, dtype=np.complex128)
        moving = omega > 0
        result[moving] = self.impedance(np.asarray(1j * omega[moving] * self.time, dtype=np.complex128))
        return result
