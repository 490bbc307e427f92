"""The simulated plant: a positioning stage that gives way under a force, softer the farther out it stands."""

from dataclasses import dataclass, field

import numpy as np

from app.virtual_plant.hidden import Hidden
from app.virtual_plant.integrate import STEPS, integrate, refined
from identification.arrays import FloatArray

MASS = 1.5  # kg
DAMPING = 0.02  # N/(mm/s)
STIFFNESS, SOFTENING = 9.0, 8.0  # N/mm, and N/mm less for each m
LENGTH = 0.6  # m
MILLIMETRES = 1e3
LONGEST_SAMPLE_TIME = 0.01  # seconds; with longer steps the integration is not exact any more
RUN_IN = 2.5  # seconds until the start is forgotten


@dataclass(frozen=True)
class Stage:
    """A stage on a screw, held at a position s between 0 and 0.6 m and pushed by a force u in N.

        1.5 ẍ + 20 ẋ + (9000 − 8000 s) x + hidden = u,   y = x + noise,   x the deflection

    in SI units; x is measured in mm with white noise of standard deviation `noise` mm.
    """

    hidden: Hidden = field(default_factory=Hidden)
    noise: float = 0.05

    def measure(
        self,
        positions: FloatArray,
        forces: FloatArray,
        sample_time: float,
        periods: int,
        generator: np.random.Generator,
    ) -> FloatArray:
        """Deflections (M, periods · L) while one period of forces (M, L) is played again and again, run in before."""
        length = forces.shape[1]
        duration = length * sample_time
        skipped = int(np.ceil(RUN_IN / duration))
        drive = self.hidden.played(refined(forces), duration)
        still = [np.zeros(len(positions)) for _ in range(2 + self.hidden.memories)]
        stiffness = STIFFNESS - SOFTENING * positions + self.hidden.stiffness(2 * positions / LENGTH - 1)

        def slope(state: list[FloatArray], push: FloatArray) -> list[FloatArray]:
            x, v, memory = state[0], state[1], state[2:]
            force = push - DAMPING * v - stiffness * x - self.hidden.force(x, v, memory)
            return [v, MILLIMETRES / MASS * force, *self.hidden.remembered(v, memory, push)]

        shown = integrate(
            slope,
            lambda state: state[0] + self.hidden.beside(state[2:]),
            still,
            drive,
            sample_time / STEPS,
            (skipped + periods) * length,
        )
        steady = shown[:, skipped * length :]
        return steady + self.noise * generator.standard_normal(steady.shape)
