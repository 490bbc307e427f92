"""Transport delay."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import EXCITED
from identification.lti.delay_search import coherent_delays, refined_delays
from identification.places.linear import Factor
from identification.places.place import Flow


@dataclass(frozen=True)
class Delay(Factor):
    """Y = e^{−jωe} G U: everything arrives later by e seconds [Ljung1999, Section 4.2]."""

    kind: ClassVar[str] = "delay"
    title: ClassVar[str] = "delay"
    unit: ClassVar[str] = "s"
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"
    sign: ClassVar[int] = 1
    states: ClassVar[float] = float("inf")

    def scan(self, flows: Sequence[Flow]) -> list[tuple[Self, float]]:
        """The delays at which what was measured turns as the model says, up to one turn over the smallest step."""
        found: list[float] = []
        for flow in flows:
            batch = flow.batch
            moving = (batch.omega > 0) & np.any((batch.classes == EXCITED) & np.isfinite(batch.variances), axis=0)
            ratio = np.sum(batch.outputs * flow.output.conj() / batch.variances, axis=0)[moving]
            omega = batch.omega[moving]
            if len(omega) > 1:
                coarse = coherent_delays(omega, ratio[1:] * ratio[:-1].conj())
                found += refined_delays(omega, ratio, coarse).tolist()
        return [(self, tau) for tau in found if tau > 0]

    def dead_time(self, e: FloatArray) -> FloatArray:
        """e."""
        return np.asarray(e[0])

    def shape(self, omega: FloatArray) -> ComplexArray:
        """−jω."""
        return np.asarray(-1j * omega)

    def factor(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """e^{−jωe}."""
        return np.asarray(np.exp(-1j * omega * e))

    def slope(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """−jω e^{−jωe}."""
        return np.asarray(-1j * omega * np.exp(-1j * omega * e))
