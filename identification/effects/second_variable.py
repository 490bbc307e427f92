"""A quantity that was logged beside the scheduling variables and that a coefficient depends on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.errors import MisuseError
from identification.places.linear import Coefficient
from identification.places.place import Effect, Flow, Setting


@dataclass(frozen=True)
class SecondVariable(Coefficient):
    """ζ_i + e (z_m − z₀), z_m the logged quantity of the m-th measurement, such as a temperature or an age.

    `quantity`: the name under which the measurements carry it, with z₀ = `reference`; or `logged`: one value a
    measurement in the order given, z₀ their mean. With neither it cannot be judged [Ghosh2018, (2)].
    """

    kind: ClassVar[str] = "second_variable"
    title: ClassVar[str] = "second scheduling variable"
    unit: ClassVar[str] = "unit of the coefficient per unit of the logged quantity"
    source: ClassVar[str] = "[Ghosh2018, (2)]"
    of_measurements: ClassVar[bool] = True

    logged: tuple[float, ...] = ()
    coefficient: int = 0
    quantity: str = ""
    reference: float = 0.0

    def direction(self, setting: Setting) -> FloatArray:
        """One for the coefficient, zero for the others."""
        chosen = np.arange(setting.structure.n_plant) == self.coefficient
        return np.repeat(chosen[None].astype(np.float64), len(setting.zeta), axis=0)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """The logged quantity less its reference; raises MisuseError where it was not logged."""
        if not self.quantity:
            logged = np.array(self.logged, dtype=np.float64)
            return np.asarray(logged[batch.members] - logged.mean())
        if self.quantity not in batch.logged:
            raise MisuseError(
                f"the model depends on {self.quantity}, which was not logged in all of these experiments; state it for"
                " each, or leave those without it out",
                "logged",
            )
        return np.asarray(batch.logged[self.quantity] - self.reference)

    def judgeable(self, flow: Flow) -> bool:
        """Only when the quantity was logged for every measurement of the batch."""
        return self.quantity in flow.batch.logged or len(self.logged) > int(flow.batch.members.max())

    def variants(self, flow: Flow) -> list[Self]:
        """The same quantity acting on every coefficient."""
        return [replace(self, coefficient=i) for i in range(flow.setting.structure.n_plant)]


def with_logged(effects: Sequence[Effect], batches: Sequence[Batch]) -> tuple[Effect, ...]:
    """The effects, with one second variable for each quantity that all batches carry in place of one without any."""
    names = sorted(set.intersection(*(set(batch.logged) for batch in batches)))
    found = tuple(
        SecondVariable(quantity=name, reference=float(np.mean(np.concatenate([b.logged[name] for b in batches]))))
        for name in names
    )
    return tuple(new for one in effects for new in (found if found and one == SecondVariable() else (one,)))
