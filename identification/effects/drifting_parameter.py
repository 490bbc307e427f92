"""A parameter of the plant that drifts within a record."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray
from identification.places.place import Flow
from identification.places.variance import ParameterSpread


@dataclass(frozen=True)
class DriftingParameter(ParameterSpread):
    """ζ_i (1 + τ n_m (p − (P + 1)/2)) in the p-th period of the m-th record, n_m random.

    The mean over the periods hardly changes, but the periods do, from first to last in proportion to their number
    [PintelonSchoukens2012, Section 2.5].
    """

    kind: ClassVar[str] = "drifting_parameter"
    title: ClassVar[str] = "parameter that drifts within a record"
    unit: ClassVar[str] = "part of the coefficient a period"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.5]"
    of_periods: ClassVar[bool] = True
    advice: ClassVar[str] = "let the plant come to rest before recording, or record shorter and log what changes"

    def change(self, flow: Flow) -> ComplexArray:
        """ζ_i ∂Y/∂ζ_i √((P² − 1)/12), as seen in the slopes of a batch over P periods."""
        count = flow.batch.raw_freedom / 2 + 1
        return np.asarray(super().change(flow) * np.sqrt((count**2 - 1) / 12))
