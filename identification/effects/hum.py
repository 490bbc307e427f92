"""A periodic disturbance."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.comparison.batch import EXCITED
from identification.places.nonlinear import Added
from identification.places.place import Flow


@dataclass(frozen=True)
class Hum(Added):
    """y + e₁ cos(2πct/T) + e₂ sin(2πct/T), c = `cycles` in a period.

    Mains hum or a machine nearby, in step with the period [PintelonSchoukens2012, Section 2.4].
    """

    kind: ClassVar[str] = "hum"
    title: ClassVar[str] = "periodic disturbance"
    unit: ClassVar[str] = "output unit"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"

    cycles: float = 1.0

    @property
    def shapes(self) -> int:
        """Cosine and sine."""
        return 2

    def signal(self, time: FloatArray) -> FloatArray:
        """Cosine and sine."""
        return np.stack([np.cos(2 * np.pi * self.cycles * time), np.sin(2 * np.pi * self.cycles * time)])

    def variants(self, flow: Flow) -> list[Self]:
        """The three unexcited lines with most of what all records have in common."""
        batch, lines = flow.batch, self._unexcited(flow)
        common = abs(np.sum((batch.outputs - flow.output) / batch.variances, axis=0))[lines]
        return [replace(self, cycles=float(k)) for k in lines[np.argsort(common)[-3:]]]

    def looked_at(self, flow: Flow) -> int:
        """All unexcited lines."""
        return max(len(self._unexcited(flow)), 1)

    @staticmethod
    def _unexcited(flow: Flow) -> IntArray:
        batch = flow.batch
        free = np.all((batch.classes != EXCITED) & np.isfinite(batch.variances), axis=0) & ~batch.real
        return np.flatnonzero(free)
