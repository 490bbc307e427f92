"""A higher order in p than a coefficient of the model has."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.linear import Coefficient
from identification.places.place import Flow, Setting


@dataclass(frozen=True)
class LegendreDependence(Coefficient):
    """ζ_i(p) + e P_d(p̃), the Legendre polynomial of degree d = `degree` in p̃ = −1 … 1, i = `coefficient`."""

    degree: ClassVar[int]

    coefficient: int = 0
    variable: int = 0

    def __init_subclass__(cls, **more: object) -> None:
        super().__init_subclass__(**more)
        cls.points_needed = getattr(cls, "degree", 0) + 1

    def direction(self, setting: Setting) -> FloatArray:
        """One for the coefficient, zero for the others."""
        chosen = np.arange(setting.structure.n_plant) == self.coefficient
        return np.repeat(chosen[None].astype(np.float64), len(setting.zeta), axis=0)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """P_d(p̃)."""
        only = np.eye(self.degree + 1)[self.degree]
        return np.asarray(np.polynomial.legendre.legval(setting.points[:, self.variable], only))

    def variants(self, flow: Flow) -> list[Self]:
        """Every coefficient of the plant and every scheduling variable."""
        sizes = flow.setting.structure.n_plant, flow.setting.points.shape[1]
        return [replace(self, coefficient=i, variable=s) for i in range(sizes[0]) for s in range(sizes[1])]
