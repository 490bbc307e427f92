"""A resistance beside a constant-phase element."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class CpeArc(Parallel):
    """Y = (G + e/(1 + (jωτ)^α)) U, τ = `time`.

    A depressed arc, as of rough electrodes [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "cpe_arc"
    title: ClassVar[str] = "arc with constant-phase element"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = float("inf")
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("time", "time", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)),
        FurtherParameter("exponent", "number", (0.55, 0.75), lowest=0.4, highest=0.95),
    )

    time: float = 1.0
    exponent: float = 0.7

    def shape(self, omega: FloatArray) -> ComplexArray:
        """1/(1 + (jωτ)^α)."""
        return np.asarray(1 / (1 + (1j * omega * self.time) ** self.exponent))
