"""A steady drift of the output."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Added


@dataclass(frozen=True)
class Drift(Added):
    """y + e t/T.

    A ramp of e each period, which in the mean over the periods is a sawtooth [PintelonSchoukens2012, Section
    2.4].
    """

    kind: ClassVar[str] = "drift"
    title: ClassVar[str] = "drift"
    unit: ClassVar[str] = "output unit per period"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"

    def signal(self, time: FloatArray) -> FloatArray:
        """t/T − 1/2."""
        return time[None] - 0.5
