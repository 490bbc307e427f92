"""Play between actuator and plant."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.memory import play
from identification.places.nonlinear import Actuator
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class Backlash(Actuator):
    """g(u) = u + e (play(u) − u), a play of ± `level`; e = 1 is free play [Nordin2002, Section 2]."""

    kind: ClassVar[str] = "backlash"
    title: ClassVar[str] = "backlash"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "1 (share of the force that passes the play)"
    source: ClassVar[str] = "[Nordin2002, Section 2]"
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 1.5
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("level", "input", (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)),
    )

    level: float = 0.1

    def shape(self, u: FloatArray) -> FloatArray:
        """play(u) − u."""
        return play(u, self.level) - u
