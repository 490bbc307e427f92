"""The loop that forces close around a plant."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.places.in_time import PlantsInTime, plants_in_time
from identification.places.intersample import Between
from identification.places.motion import displacement, flow_rate, static_stiffness
from identification.places.nonlinear import Feedback
from identification.places.place import Setting

BALANCING, PASSES = 4, 2


@dataclass(frozen=True, eq=False)
class Loop:
    """X = H U − G F{Σ e_j f_j(q, q̇)}, q = s^(−d) x: G `response`, U `entering` (M, K), forces with e (M, 1).

    H = `entry` is G as the input is seen through its hold.

    Unknowns are the lines X (M, K) and, for d ≥ 1, the mean q₀ of the displacement as a further column (M, K + 1), for
    which the forces balance at ω = 0: K q₀ + F₀ = U₀ with the static stiffness K of the plant. `between`: the motion
    between the samples for X and the drive, where the plant is followed there; forces are then held at their means.
    """

    response: ComplexArray
    entry: ComplexArray
    entering: ComplexArray
    forces: Sequence[tuple[Feedback, FloatArray]]
    batch: Batch
    finer: int
    between: Between | None = None
    setting: Setting | None = None

    @cached_property
    def order(self) -> int:
        """The largest d of the forces that act on the displacement."""
        return max((effect.order for effect, _ in self.forces if effect.on_displacement), default=0)

    @cached_property
    def stiffness(self) -> FloatArray:
        """K (M,)."""
        return static_stiffness(self.response, self.batch, self.order)

    @cached_property
    def plants(self) -> PlantsInTime | None:
        """The plants as states on the time grid, where all forces act on the same motion, all at once or all later."""
        kinds = {(effect.order, effect.differentiated) for effect, _ in self.forces}
        if self.setting is None or len(kinds) != 1 or self.batch.sample_time is None or self.batch.signals is None:
            return None
        ((order, differentiated),) = kinds
        length, structure = self.batch.signals.shape[1] * self.finer, self.setting.structure
        found = plants_in_time(structure, self.setting.zeta, self.batch.sample_time, self.finer, length, order)
        return found.of_rates if found is not None and differentiated else found

    def motion(
        self, effect: Feedback, x: ComplexArray, force: ComplexArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """q and q̇ (M, L·finer) that an effect sees; between the samples where the plant is followed there."""
        core, mean = self.split(x)
        if effect.order == 0 and self.between is not None:
            return self.between(core, self.entering - (self.force_lines(x) if force is None else force))
        if effect.order == 0 and not self.batch.repeats:
            return self.batch.signal(core, self.finer), self.batch.rate(core, self.finer)
        q = displacement(core, mean, self.batch, effect.order)
        return self.batch.signal(q, self.finer), self.batch.signal(
            flow_rate(core, self.batch, effect.order), self.finer
        )

    def split(self, x: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        """The lines and the mean; without it zero."""
        return x[:, : len(self.batch.omega)], x[:, -1].real if self.order else np.zeros(len(x))

    @property
    def free_motion(self) -> tuple[FloatArray, FloatArray]:
        """q and q̇ (M, L·finer) without forces."""
        return self.motion(self.forces[0][0], self.start(self.driven), np.zeros_like(self.driven))

    def lines_of(self, force: FloatArray) -> ComplexArray:
        """F (M, K) of a force (M, L·finer) in time."""
        held = self.finer if self.between is not None else 1
        kept = force if held == 1 else force.reshape(len(force), -1, held).mean(axis=-1)
        return np.asarray(self.forces[0][0].rates(self.batch) * self.batch.spectrum(kept))

    def of_force(self, force: FloatArray) -> ComplexArray:
        """The unknowns for a force (M, L·finer) in time."""
        return self.balanced(self.start(self.answer(self.lines_of(force))))

    def force_lines(self, x: ComplexArray) -> ComplexArray:
        """F (M, K) of all forces."""
        total = np.zeros_like(self.response)
        for _ in range(1 if self.between is None else PASSES):
            before, total = total, np.zeros_like(self.response)
            for effect, e in self.forces:
                held = 1 if self.between is None or effect.order else self.finer
                total += e * effect.lines(self.batch, *self.motion(effect, x, before), held)
        return total

    @cached_property
    def driven(self) -> ComplexArray:
        """What the input alone makes of X (M, K)."""
        return np.asarray(self.entry * self.entering)

    def answer(self, force: ComplexArray) -> ComplexArray:
        """X (M, K) for a force (M, K), with the transient that brings it nearest to a record that does not repeat."""
        moved = self.driven - self.response * force
        return np.asarray(moved + self.batch.transient(moved))

    def update(self, x: ComplexArray) -> ComplexArray:
        """What the lines and the mean would have to be for the forces that they cause."""
        force = self.force_lines(x)
        moved = self.answer(force)
        if not self.order:
            return np.asarray(moved)
        mean = x[:, -1].real
        balance = (self.stiffness * mean + (force - self.entering)[:, 0].real) / self.yielding(x)
        return np.concatenate([moved, (mean - balance)[:, None]], axis=1)

    def yielding(self, x: ComplexArray) -> FloatArray:
        """How fast the balance at ω = 0 changes with the mean, (M,)."""
        by_mean = sum(
            (e[:, 0] * effect.slopes(*self.motion(effect, x))[0].mean(axis=1) for effect, e in self._displaced),
            start=np.zeros(len(x)),
        )
        total = self.stiffness + np.maximum(by_mean, 0.0)
        return np.where(total > 0, total, 1.0)

    @cached_property
    def _displaced(self) -> list[tuple[Feedback, FloatArray]]:
        return [(effect, e) for effect, e in self.forces if effect.on_displacement and effect.order]

    def start(self, core: ComplexArray, mean: FloatArray | None = None) -> ComplexArray:
        """Unknowns from the lines X."""
        if not self.order:
            return core
        at = np.zeros(len(core)) if mean is None else mean
        return np.concatenate([core, at[:, None]], axis=1)

    def balanced(self, x: ComplexArray) -> ComplexArray:
        """The unknowns with the lines as they are and the mean for which the forces balance."""
        for _ in range(BALANCING if self.order else 0):
            x = np.concatenate([x[:, :-1], self.update(x)[:, -1:]], axis=1)
        return x

    def part(self, share: float) -> "Loop":
        """The loop with a share of all forces."""
        return self if share >= 1 else replace(self, forces=[(effect, share * e) for effect, e in self.forces])

    @property
    def jumps(self) -> bool:
        """Whether a force depends on more than a moment, as those that jump do."""
        return not all(effect.at_once for effect, _ in self.forces)

    def rounded(self, width: float) -> "Loop":
        """The loop with the corners of all forces rounded off."""
        return replace(self, forces=[(effect.rounded(width), e) for effect, e in self.forces])
