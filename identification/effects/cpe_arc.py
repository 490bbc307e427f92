"""A resistance beside a constant-phase element."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray
from identification.places.moving import RATIO
from identification.places.place import FurtherParameter
from identification.places.relaxation import TIME, Relaxation


@dataclass(frozen=True)
class CpeArc(Relaxation):
    """Y = (G + e/(1 + (jωτ)^α)) U, τ = `time`, α = `exponent`.

    A depressed arc, as of rough electrodes [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "cpe_arc"
    title: ClassVar[str] = "arc with constant-phase element"
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        TIME,
        FurtherParameter("exponent", "number", (0.55, 0.75), lowest=0.4, highest=0.95),
        RATIO,
    )

    exponent: float = 0.7

    def impedance(self, s: ComplexArray) -> ComplexArray:
        """1/(1 + s^α)."""
        return np.asarray(1 / (1 + s**self.exponent))
