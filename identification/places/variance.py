"""Effects that change the variance of what is measured, not its mean."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.place import Flow


@dataclass(frozen=True)
class VarianceEffect(ABC):
    """V = V₀ + τ² Σ_m s_m s_mᴴ, m over the records: each deviates along s_m by a random amount of its own.

    `advice`: what to do about it; `of_periods`: it shows in how the periods of a record change from first to last, not
    in their mean; `within_points`: it is judged by how records at one operating point differ, which no dependence on p
    and no misplaced point can explain; `direct`: the records tell of it without a model (`seen`). τ is in `unit`, and
    never negative.
    """

    kind: ClassVar[str]
    title: ClassVar[str]
    unit: ClassVar[str]
    source: ClassVar[str]
    advice: ClassVar[str]
    place: ClassVar[str] = "variance"
    of_periods: ClassVar[bool] = False
    within_points: ClassVar[bool] = False
    direct: ClassVar[bool] = False

    @classmethod
    def example(cls) -> Self:
        """An instance for tests and catalogues."""
        return cls()

    @abstractmethod
    def variants(self, flow: Flow) -> list[Self]:
        """The effect over its further parameters."""

    def seen(self, flows: Sequence[Flow]) -> tuple[float, float] | None:
        """τ̂ and its p-value where the records tell them without a model; None where they do not."""
        return None

    def change(self, flow: Flow) -> ComplexArray | None:
        """s (M, K), the change of the output of every record by τ = 1; None where it is not of this kind."""
        return None

    def power(self, flow: Flow) -> FloatArray | None:
        """E|n|² (M, K) that τ = 1 adds to every line on its own; None where it is not of this kind."""
        return None


@dataclass(frozen=True)
class ParameterSpread(VarianceEffect):
    """A coefficient ζ_i, i = `coefficient`, differs by a random part of its size: s = ζ_i ∂Y/∂ζ_i."""

    unit: ClassVar[str] = "part of the coefficient"

    coefficient: int = 0

    def variants(self, flow: Flow) -> list[Self]:
        """Every coefficient of the plant."""
        return [replace(self, coefficient=i) for i in range(flow.setting.structure.n_plant)]

    def change(self, flow: Flow) -> ComplexArray:
        """ζ_i ∂Y/∂ζ_i."""
        size = flow.setting.zeta[:, self.coefficient, None]
        return np.asarray(size * flow.by_coefficients[:, self.coefficient])
