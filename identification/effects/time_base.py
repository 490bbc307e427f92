"""Clocks that differ."""

from dataclasses import dataclass
from typing import ClassVar

from identification.places.frequency_axis import FrequencyAxis


@dataclass(frozen=True)
class TimeBase(FrequencyAxis):
    """Y = G((1 + e) ω) U.

    The clock of the measurement runs faster by the share e than that of the model [PintelonSchoukens2012,
    Section 2.4].
    """

    kind: ClassVar[str] = "time_base"
    title: ClassVar[str] = "time-base mismatch"
    unit: ClassVar[str] = "1"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"
    largest: ClassVar[float | None] = 0.5
