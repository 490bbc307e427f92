"""A coefficient with a quadratic part in the scheduling variable that the model has not."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.linear import Coefficient
from identification.places.place import Flow, Setting


@dataclass(frozen=True)
class QuadraticDependence(Coefficient):
    """ζ_i(p) + e P_2(p̃), the Legendre polynomial of degree 2 in p̃ = −1 … 1, i = `coefficient` [Ghosh2018, (2)]."""

    kind: ClassVar[str] = "quadratic_dependence"
    title: ClassVar[str] = "quadratic dependence of a coefficient on p"
    unit: ClassVar[str] = "unit of the coefficient"
    source: ClassVar[str] = "[Ghosh2018, (2)]"

    coefficient: int = 0
    variable: int = 0

    def direction(self, setting: Setting) -> FloatArray:
        """One for the coefficient, zero for the others."""
        chosen = np.arange(setting.structure.n_plant) == self.coefficient
        return np.repeat(chosen[None].astype(np.float64), len(setting.zeta), axis=0)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """P_2(p̃)."""
        return np.asarray(np.polynomial.legendre.legval(setting.points[:, self.variable], np.eye(2 + 1)[2]))

    def variants(self, flow: Flow) -> list[Self]:
        """Every coefficient of the plant and every scheduling variable."""
        sizes = flow.setting.structure.n_plant, flow.setting.points.shape[1]
        return [replace(self, coefficient=i, variable=s) for i in range(sizes[0]) for s in range(sizes[1])]
