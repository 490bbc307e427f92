"""Inductance with eddy currents."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class LossyInductance(Parallel):
    """Y = (G + e (jω)^α) U, 0.3 < α < 1: skin effect and eddy currents [Barsoukov2005, Section 2.1]."""

    kind: ClassVar[str] = "lossy_inductance"
    title: ClassVar[str] = "lossy inductance"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit · s^α"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = float("inf")
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("exponent", "number", (0.4, 0.6, 0.8), lowest=0.3, highest=0.9),
    )

    exponent: float = 0.6

    def shape(self, omega: FloatArray) -> ComplexArray:
        """(jω)^α."""
        return np.asarray((1j * omega) ** self.exponent)
