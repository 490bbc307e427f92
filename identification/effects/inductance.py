"""Series inductance."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel


@dataclass(frozen=True)
class Inductance(Parallel):
    """Y = (G + jωe) U: cables and windings in series [Barsoukov2005, Section 2.1]."""

    kind: ClassVar[str] = "inductance"
    title: ClassVar[str] = "series inductance"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit · s (H for V/A)"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    sign: ClassVar[int] = 1

    def shape(self, omega: FloatArray) -> ComplexArray:
        """jω."""
        return np.asarray(1j * omega)
