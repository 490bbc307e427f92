"""One operating point logged wrongly."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.linear import Coefficient
from identification.places.place import Flow, Setting


@dataclass(frozen=True)
class MisplacedPoint(Coefficient):
    """ζ(p + e) in place of ζ(p) for every measurement logged at `point`, to first order in e [Ghosh2018, (2)].

    Scheduling variables are scaled to −1 … 1 over their range, so that e = 0.1 is a twentieth of the range.
    """

    kind: ClassVar[str] = "misplaced_point"
    title: ClassVar[str] = "one operating point logged wrongly"
    unit: ClassVar[str] = "half the range of the scheduling variable"
    source: ClassVar[str] = "[Ghosh2018, (2)]"
    of_measurements: ClassVar[bool] = True
    largest: ClassVar[float | None] = 2.0

    point: float = 0.0
    variable: int = 0

    def direction(self, setting: Setting) -> FloatArray:
        """∂ζ_G/∂p̃."""
        return setting.zeta_slope[:, :, self.variable]

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """One where the measurement was logged at the point."""
        return (abs(setting.points[:, self.variable] - self.point) < 1e-9).astype(np.float64)

    def variants(self, flow: Flow) -> list[Self]:
        """Every operating point of the batch."""
        points = flow.setting.points
        return [
            replace(self, point=float(p), variable=s) for s in range(points.shape[1]) for p in np.unique(points[:, s])
        ]
