"""The clock of the output runs fast or slow against that of the input."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.comparison.resampling import stretched
from identification.places.place import Flow
from identification.places.recorder import Recorder


@dataclass(frozen=True)
class ClockSkew(Recorder):
    """y((1 + e) t) in place of y(t), t from the start of the record: a phase e ω t that grows along it.

    With periods it differs from one to the next, by e ω T_period, and is judged where that was seen; without, the
    residual goes with t ẏ. A delay, a lag or a resonance turns every period alike [PintelonSchoukens2012, Section 2.4].
    """

    kind: ClassVar[str] = "clock_skew"
    title: ClassVar[str] = "clock of the output runs fast or slow"
    unit: ClassVar[str] = "1"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"
    largest: ClassVar[float | None] = 0.01
    unseen: ClassVar[str] = "the phase does not drift from period to period"

    def variants(self, flow: Flow) -> list[Self]:
        """Itself, but where the periods of a record were not seen to drift."""
        return [self] if _in_parts(flow.batch) or not flow.batch.repeats else []

    def scan(self, flows: Sequence[Flow]) -> list[tuple[Self, float]]:
        """At what the periods show."""
        seen = [flow.batch.drift for flow in flows if _in_parts(flow.batch)]
        return [(self, float(np.mean(seen)))] if seen else []

    def recorded(self, e: FloatArray, lines: ComplexArray, batch: Batch) -> ComplexArray:
        """Lines of y((1 + e) t)."""
        return stretched(lines, batch, e)

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K), that of t ẏ((1 + e) t)."""
        assert flow.shown is not None
        return stretched(flow.shown, flow.batch, e[0], by_stretch=True)[None]


def _in_parts(batch: Batch) -> bool:
    return batch.drift != 0 and batch.parts is None
