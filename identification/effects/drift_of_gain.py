"""Gain that drifts from record to record."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.places.linear import Factor
from identification.places.place import Setting


@dataclass(frozen=True)
class DriftOfGain(Factor):
    """Y_m = (1 + e (m/100 − 1/2)) G U for the m-th record in the order given [PintelonSchoukens2012, Section 2.4]."""

    kind: ClassVar[str] = "gain_drift"
    title: ClassVar[str] = "gain drift over the session"
    unit: ClassVar[str] = "1 per hundred records"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"
    of_measurements: ClassVar[bool] = True

    def shape(self, omega: FloatArray) -> ComplexArray:
        """One at all frequencies."""
        return np.ones(len(omega), dtype=np.complex128)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """The place of the record in the order given."""
        return batch.members / 100.0 - 0.5
