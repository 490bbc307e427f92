"""A notch in the response."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Factor
from identification.places.moving import RATIO, Moving
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class Antiresonance(Moving, Factor):
    """Y = (1 − e 2jζω₀ω/(ω₀² − ω² + 2jζω₀ω)) G U.

    A damper or absorber that takes out the share e of the response at ω₀ = `frequency`, ζ = `damping`
    [PintelonSchoukens2012, Section 1.3].
    """

    kind: ClassVar[str] = "antiresonance"
    title: ClassVar[str] = "anti-resonance"
    unit: ClassVar[str] = "1"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 1.3]"
    states: ClassVar[float] = 2
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter(
            "frequency", "frequency", (0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)
        ),
        FurtherParameter("damping", "number", (0.05, 0.3), highest=0.7),
        RATIO,
    )

    moves: ClassVar[str] = "frequency"

    frequency: float = 1.0
    damping: float = 0.2

    def shape(self, omega: FloatArray) -> ComplexArray:
        """−2jζω₀ω/(ω₀² − ω² + 2jζω₀ω)."""
        damping = 2j * self.damping * self.frequency * omega
        return np.asarray(-damping / (self.frequency**2 - omega**2 + damping))
