"""A second mass behind a spring."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.places.core import Plant, Reshaped
from identification.places.motion import motions
from identification.places.place import Flow, FurtherParameter, Setting
from identification.signals import HeldInput

FREQUENCIES = (0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)


@dataclass(frozen=True)
class TwoMass(Reshaped):
    """A mass e behind a spring and a damper, hung on to the output: Y = G U/(1 + e l(ω) G).

        l(s) = s^{1−d} (s + ν/g) (1 + γ s)/(1 + γ s + s (g s + ν)/ω_z²),   γ = 2ζ/ω_z,   d the `order` of the output

    ω_z = `frequency` is where the second mass holds the first still, ζ = `damping` of the spring, ν = `friction` of the
    mass itself in 1/s, d = 1 for a speed; below ω_z the masses move as one. Where the mass grows with p, to `ratio`
    times at the upper end of what it is at the lower, it is e g(p), g linear and one amid the range, and pole and zero
    move together [Ljung1999, Section 4.2].
    """

    kind: ClassVar[str] = "two_mass"
    title: ClassVar[str] = "second mass behind a spring"
    unit: ClassVar[str] = "input unit per output unit · s^(2 − d)"
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"
    sign: ClassVar[int] = 1
    states: ClassVar[float] = 2
    unjudged: ClassVar[str] = "the model is in discrete time, where forces and masses have no place of their own"
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("frequency", "frequency", FREQUENCIES),
        FurtherParameter("damping", "number", (0.05,), highest=0.7),
        FurtherParameter("ratio", "number", (1.0,), lowest=0.02, highest=50.0),
        FurtherParameter("friction", "number", (0.0,)),
    )

    frequency: float = 1.0
    damping: float = 0.05
    ratio: float = 1.0
    friction: float = 0.0
    variable: int = 0
    order: int = 1

    def growth(self, points: FloatArray) -> FloatArray:
        """g (M,) at the scaled operating points (M, s)."""
        return np.asarray(1 + (self.ratio - 1) / (self.ratio + 1) * points[:, self.variable])

    def profile(self, setting: Setting, batch: Batch) -> FloatArray:
        """g(p): how the mass grows."""
        return self.growth(setting.points)

    def load(self, points: FloatArray, omega: FloatArray) -> ComplexArray:
        """l (M, K)."""
        s, g = 1j * omega, self.growth(points)[:, None]
        spring = 1 + 2 * self.damping / self.frequency * s
        carried = (s + self.friction / g) * spring / (spring + s * (g * s + self.friction) / self.frequency**2)
        return np.asarray(s ** (1 - self.order) * carried)

    def reshaped(
        self, e: FloatArray, plant: Plant, setting: Setting, omega: FloatArray, held: HeldInput | None
    ) -> ComplexArray:
        """G/(1 + e l G) (M, K) for e (M,)."""
        alone = plant(setting.zeta, omega, None)
        with np.errstate(invalid="ignore"):
            loop = np.where(omega > 0, e[:, None] * self.load(setting.points, omega) * alone, 0.0)
        seen = alone if held is None else plant(setting.zeta, omega, held)
        return np.asarray(seen / (1 + loop))

    def small(self, flow: Flow) -> float:
        """A thousandth of the mass that counts as much as the plant."""
        moving = flow.batch.omega > 0
        loop = self.load(flow.setting.points, flow.batch.omega[moving]) * flow.response[:, moving]
        return float(1e-3 / max(abs(loop).max(), 1e-300))

    def scan(self, flows: Sequence[Flow]) -> list[tuple[Self, float]]:
        """Masses from a fifth to twice of what counts as much as the plant at ω_z."""
        found = []
        points = np.concatenate([flow.setting.points for flow in flows])
        for one in self.variants(flows[0]):
            near = [abs(f.response[:, np.argmin(abs(f.batch.omega - one.frequency))]) for f in flows]
            equal = float(1 / (one.frequency ** (2 - self.order) * np.median(np.concatenate(near))))
            grown = [one, *one.growing(points, (0.4, 2.5))]
            found += [(each, share * equal) for each in grown for share in (0.25, 1.0)]
        return found

    def growing(self, points: FloatArray, ratios: tuple[float, ...]) -> list[Self]:
        """Masses that grow over each scheduling variable that changes."""
        variables = np.flatnonzero(np.ptp(points, axis=0) > 0)
        return [replace(self, ratio=ratio, variable=int(s)) for s in variables for ratio in ratios]

    def fixed(self, parameter: FurtherParameter) -> bool:
        """A mass that does not grow, or has no friction, is left so by a refit."""
        return (parameter.name == "ratio" and self.ratio == 1.0) or (parameter.name == "friction" and not self.friction)

    def freer(self, points: FloatArray) -> list[Self]:
        """With friction of the mass; growing."""
        rubbing = [] if self.friction else [replace(self, friction=share * self.frequency) for share in (0.003, 0.03)]
        return [*rubbing, *(self.growing(points, (1.3, 0.77)) if self.ratio == 1.0 else [])]

    def judgeable(self, flow: Flow) -> bool:
        """Only in continuous time."""
        return not flow.setting.structure.is_discrete

    def variants(self, flow: Flow) -> list[Self]:
        """The grid of the frequencies, for every order of the output."""
        grid = super().variants(flow)
        orders = [order for order, of_input in motions(flow.batch.channels) if not of_input]
        return [replace(one, order=order) for order in orders for one in grid]
