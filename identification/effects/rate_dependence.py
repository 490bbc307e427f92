"""Coefficients that depend on how fast the scheduling variable changes."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.linear import Coefficient
from identification.places.place import Flow, Setting


@dataclass(frozen=True)
class RateDependence(Coefficient):
    """ζ_i + e ṗ_m, ṗ_m the rate of change of the scheduling variable during the m-th measurement [Toth2010, Chapter 3].

    `rates`: one value a measurement in the order given, small enough for p to be nearly constant within it; without
    them the operating points stand still, and no such experiment can show the effect.
    """

    kind: ClassVar[str] = "rate_dependence"
    title: ClassVar[str] = "dependence on the rate of change of the scheduling variable"
    unit: ClassVar[str] = "unit of the coefficient per unit of the scheduling variable and second"
    source: ClassVar[str] = "[Toth2010, Chapter 3]"
    of_measurements: ClassVar[bool] = True
    unseen: ClassVar[str] = "invisible while operating points stand still: let p change during an experiment"

    rates: tuple[float, ...] = ()
    coefficient: int = 0

    def direction(self, setting: Setting) -> FloatArray:
        """One for the coefficient, zero for the others."""
        chosen = np.arange(setting.structure.n_plant) == self.coefficient
        return np.repeat(chosen[None].astype(np.float64), len(setting.zeta), axis=0)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """The rate of change, zero where none is known."""
        rates = np.zeros(max(len(self.rates), int(batch.members.max()) + 1))
        rates[: len(self.rates)] = self.rates
        return np.asarray(rates[batch.members])

    def variants(self, flow: Flow) -> list[Self]:
        """Every coefficient of the plant."""
        return [replace(self, coefficient=i) for i in range(flow.setting.structure.n_plant)]
