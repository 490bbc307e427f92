"""Diffusion towards a reservoir."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class WarburgShort(Parallel):
    """Y = (G + e tanh(√(jωτ))/√(jωτ)) U, τ = `time`.

    Finite length, the end held at constant concentration or temperature [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "warburg_short"
    title: ClassVar[str] = "diffusion, open end"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = float("inf")
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("time", "time", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)),
    )

    time: float = 1.0

    def shape(self, omega: FloatArray) -> ComplexArray:
        """The impedance for e = 1; nothing at ω = 0."""
        result = np.zeros(len(omega), dtype=np.complex128)
        positive = omega > 0
        root = np.sqrt(1j * omega[positive] * self.time)
        result[positive] = np.tanh(root) / root
        return result
