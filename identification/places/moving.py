"""Effects one of whose further parameters may change over the range of a scheduling variable."""

from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.places.place import Effect, FurtherParameter

RATIO = FurtherParameter("ratio", "number", (1.0,), lowest=0.02, highest=50.0)


@dataclass(frozen=True)
class Moving(Effect):
    """The further parameter η that `moves` is η ρ^{p̃/2} at p̃ = −1 … 1: ρ = `ratio` times as large at the upper end.

    With ρ = 1 it stands still, and ρ is not fitted. `variable`: the scheduling variable.
    """

    moves: ClassVar[str]

    ratio: float = field(default=1.0, kw_only=True)
    variable: int = field(default=0, kw_only=True)

    def fixed(self, parameter: FurtherParameter) -> bool:
        """Whether a further parameter is left as it is by a refit."""
        return super().fixed(parameter) or (parameter.name == RATIO.name and self.ratio == 1.0)

    def at(self, points: FloatArray) -> list[Self]:
        """The effect at each of the scaled operating points (M, s); one for all where it stands still."""
        if self.ratio == 1.0:
            return [self]
        still = replace(self, ratio=1.0)
        names, values, moved = still.fitted_names(), still.values(), []
        for factor in self.ratio ** (points[:, self.variable] / 2):
            moved.append(still.with_values(np.where(np.array(names) == self.moves, values * factor, values)))
        return moved

    def freer(self, points: FloatArray) -> list[Self]:
        """With its parameter on the move, by a little and by much, up and down, where the points (M, s) differ."""
        if self.ratio != 1.0:
            return []
        variables = np.flatnonzero(np.ptp(points, axis=0) > 0)
        return [replace(self, ratio=r, variable=int(s)) for s in variables for r in (1.2, 3.0, 1 / 3)]
