"""A further mode of vibration."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.moving import RATIO, Moving
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class Resonance(Moving, Parallel):
    """Y = (G + e/(ω₀² − ω² + 2jζω₀ω)) U.

    One more mode of modal constant e, ω₀ = `frequency`, ζ = `damping` [PintelonSchoukens2012, Section 1.3].
    """

    kind: ClassVar[str] = "resonance"
    title: ClassVar[str] = "extra resonance"
    unit: ClassVar[str] = "output unit per input unit · rad²/s²"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 1.3]"
    within: ClassVar[bool] = True
    states: ClassVar[float] = 2
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter(
            "frequency", "frequency", (0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)
        ),
        FurtherParameter("damping", "number", (0.02, 0.15), highest=0.4),
        RATIO,
    )

    moves: ClassVar[str] = "frequency"

    frequency: float = 1.0
    damping: float = 0.05

    def shape(self, omega: FloatArray) -> ComplexArray:
        """1/(ω₀² − ω² + 2jζω₀ω)."""
        return np.asarray(1 / (self.frequency**2 - omega**2 + 2j * self.damping * self.frequency * omega))
