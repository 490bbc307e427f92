"""A basis that is too low for all coefficients at once, or a model divided through by what depends on p."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import BoolArray, FloatArray
from identification.comparison.batch import Batch
from identification.models.structure import Structure
from identification.places.linear import Divisor
from identification.places.place import Flow, Setting

ALL, DELAY = -1, "tau"


@dataclass(frozen=True)
class LowBasis(Divisor):
    """ζ_i(p)/(1 + e P_d(p̃)), the Legendre polynomial of degree d in p̃ = −1 … 1, for one coefficient or for all.

    J(p) ω′ + d ω = k u has coefficients d/J(p) and k/J(p) once the leading one is one: all of them then go as 1/J(p)
    and no low basis fits, while one number does. A single coefficient that goes as 1/p is another case of it. `degree`
    d, `coefficient` i, −1 for all [Toth2010, Chapter 3].
    """

    kind: ClassVar[str] = "low_basis"
    title: ClassVar[str] = "too low a basis in p, or another normalisation"
    unit: ClassVar[str] = "1"
    source: ClassVar[str] = "[Toth2010, Chapter 3]"
    largest: ClassVar[float | None] = 0.98
    unjudged: ClassVar[str] = "the coefficients of the model are entries of matrices, which say nothing one by one"
    unseen: ClassVar[str] = "invisible in this experiment: it needs more operating points than the bases have functions"

    coefficient: int = ALL
    variable: int = 0
    degree: int = 1

    def divided(self, structure: Structure) -> BoolArray:
        """The coefficient, or all but a delay."""
        if self.coefficient != ALL:
            return np.asarray(np.arange(structure.n_plant) == self.coefficient)
        return np.array([name != DELAY for name in structure.coefficient_names[: structure.n_plant]])

    def judgeable(self, flow: Flow) -> bool:
        """Only where every coefficient has a basis of its own, and a meaning: not for the entries of matrices."""
        return all(len(group.entries) == 1 for group in flow.setting.structure.groups)

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """P_d(p̃)."""
        only = np.eye(self.degree + 1)[self.degree]
        return np.asarray(np.polynomial.legendre.legval(setting.points[:, self.variable], only))

    def variants(self, flow: Flow) -> list[Self]:
        """All coefficients at once and every one alone, every scheduling variable; degree 2 for all at once."""
        variables = flow.setting.points.shape[1]
        one_by_one = np.flatnonzero(self.divided(flow.setting.structure))
        chosen = [(ALL, 1), (ALL, 2), *((int(i), 1) for i in one_by_one)]
        return [replace(self, coefficient=i, degree=d, variable=s) for i, d in chosen for s in range(variables)]
