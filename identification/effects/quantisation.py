"""The rounding of a converter."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.places.place import Flow
from identification.places.variance import VarianceEffect


@dataclass(frozen=True)
class Quantisation(VarianceEffect):
    """y rounded to multiples of τ: E|n|² = τ²/(12 L) at every line of the mean of periods of L samples.

    It repeats with the period, so that how the periods differ does not show it [WidrowKollar2008, Section 4].
    """

    kind: ClassVar[str] = "quantisation"
    title: ClassVar[str] = "rounding of the converter"
    unit: ClassVar[str] = "output unit"
    source: ClassVar[str] = "[WidrowKollar2008, Section 4]"
    advice: ClassVar[str] = "use a finer range of the converter, or a larger input"

    def variants(self, flow: Flow) -> list[Self]:
        """Itself, where the input repeats: noise on an input is not told from it, nor is noise from its own rest."""
        return [self] if flow.batch.adaptation is None else []

    def power(self, flow: Flow) -> FloatArray:
        """1/(12 L), at real lines twice that."""
        batch = flow.batch
        length = 1 if batch.signals is None else batch.signals.shape[-1]
        return np.broadcast_to(np.where(batch.real, 2.0, 1.0) / (12 * length), batch.outputs.shape)
