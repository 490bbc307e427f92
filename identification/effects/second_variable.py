"""A quantity that was logged beside the scheduling variables and that a coefficient depends on."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.linear import Coefficient
from identification.places.place import Flow, Setting


@dataclass(frozen=True)
class SecondVariable(Coefficient):
    """ζ_i + e z_m, z_m the logged quantity of the m-th measurement, such as a temperature or an age [Ghosh2018, (2)].

    `logged`: one value a measurement in the order given; without them the effect cannot be judged.
    """

    kind: ClassVar[str] = "second_variable"
    title: ClassVar[str] = "second scheduling variable"
    unit: ClassVar[str] = "unit of the coefficient per unit of the logged quantity"
    source: ClassVar[str] = "[Ghosh2018, (2)]"
    of_measurements: ClassVar[bool] = True

    logged: tuple[float, ...] = ()
    coefficient: int = 0

    def direction(self, setting: Setting) -> FloatArray:
        """One for the coefficient, zero for the others."""
        chosen = np.arange(setting.structure.n_plant) == self.coefficient
        return np.repeat(chosen[None].astype(np.float64), len(setting.zeta), axis=0)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """The logged quantity less its mean."""
        logged = np.array(self.logged, dtype=np.float64)
        return np.asarray(logged[batch.members] - logged.mean())

    def judgeable(self, flow: Flow) -> bool:
        """Only when the quantity was logged for every measurement of the batch."""
        return len(self.logged) > int(flow.batch.members.max())

    def variants(self, flow: Flow) -> list[Self]:
        """The same quantity acting on every coefficient."""
        return [replace(self, coefficient=i) for i in range(flow.setting.structure.n_plant)]
