"""Discs with their centre on the real axis."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.pole_regions.inequality import PoleRegion, require_finite


@dataclass(frozen=True)
class Disc(PoleRegion):
    """|z − c| < r; with c = 0 and r = 1 the stable models in discrete time [Kergus2019, Remark 5].

    f(z) = [−r, z − c; z̄ − c, −r]
    """

    kind: ClassVar[str] = "disc"

    radius: Annotated[float, "radius r > 0"] = 1.0
    centre: Annotated[float, "centre c on the real axis"] = 0.0

    def __post_init__(self) -> None:
        require_finite(self.radius, "radius", positive=True)
        require_finite(self.centre, "centre")

    @property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """P and Q, both (2, 2)."""
        r, c = self.radius, self.centre
        return np.array([[-r, -c], [-c, -r]]), np.array([[0.0, 1.0], [0.0, 0.0]])

    @property
    def real_interval(self) -> tuple[float, float]:
        """(c − r, c + r)."""
        return self.centre - self.radius, self.centre + self.radius

    @classmethod
    def example(cls) -> "Disc":
        """The unit disc."""
        return cls()
