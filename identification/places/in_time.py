"""Plants as states that follow in time, and their loops with forces linearised there."""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import expm

from identification.arrays import FloatArray
from identification.models.structure import Structure
from identification.places.intersample import logarithm
from identification.places.scan import Recursion

LEAK, LEAST = 1e-2, 0.2


@dataclass(frozen=True, eq=False)
class PlantsInTime:
    """ẇ = A w + B u, (q, q̇) = C w + D u for the M plants of a batch on a grid of steps h.

    `generator` A, `transition` exp(A h) (n, n, M), `entry` B (n, M), `motion` C (2, n, M), `direct` D (2, M). Outputs
    of order d ≥ 1 are integrated to the displacement. States that would stay, and these integrators, leak a hundredth
    of themselves over the grid, so that they are those of a period as well.
    """

    generator: FloatArray
    transition: FloatArray
    entry: FloatArray
    motion: FloatArray
    direct: FloatArray
    step: float

    def held(self, share: float) -> tuple[FloatArray, FloatArray]:
        """exp(A h') (n, n, M) and ∫ exp(A s) ds B (n, M) over a `share` h' of a step."""
        n, m = self.entry.shape
        full = np.zeros((m, n + 1, n + 1))
        full[:, :n, :n], full[:, :n, n] = np.moveaxis(self.generator, -1, 0), self.entry.T
        found = np.moveaxis(expm(full * (share * self.step)), 0, -1)
        return found[:n, :n], found[:n, n]

    @property
    def of_rates(self) -> "PlantsInTime":
        """The same plants driven by the rate of u: w − B u follows A (w − B u) + A B u; D stands for nothing then."""
        entry = np.einsum("ijm,jm->im", self.generator, self.entry)
        return replace(self, entry=entry, direct=np.einsum("cim,im->cm", self.motion, self.entry))


def plants_in_time(
    structure: Structure, zeta: FloatArray, sample_time: float, finer: int, length: int, order: int
) -> PlantsInTime | None:
    """The plants at ζ (M, n) on a grid of `length` steps, `finer` than the samples; None where one has no states.

    So with an estimated delay, for a discrete-time plant that no plant in continuous time is sampled to, and for
    structures that do not say.
    """
    step = sample_time / finer
    leak = LEAK / (length * step)
    every = [_in_time(structure, one.tobytes(), sample_time, step, leak, order) for one in zeta]
    known = [one for one in every if one is not None]
    if len(known) < len(every):
        return None
    generator, transition, entry, motion, direct = (np.stack(parts, axis=-1) for parts in zip(*known, strict=True))
    return PlantsInTime(generator, transition, entry, motion, direct, step)


@lru_cache(maxsize=512)
def _in_time(
    structure: Structure, zeta: bytes, sample_time: float, step: float, leak: float, order: int
) -> tuple[FloatArray, ...] | None:
    """A, exp(A h), B, C, D of one plant."""
    over = sample_time if structure.is_discrete else step
    own, zeta_of_own, direct = structure.without_direct_path(np.frombuffer(zeta))
    found = own.sampled(zeta_of_own, over)
    if found is None or (direct and not order) or not np.all(np.isfinite(found[0])):
        return None
    generator = logarithm(found[0])
    if generator is None:
        return None
    n = len(found[1])
    a, b = np.zeros((n + order, n + order)), np.zeros(n + order)
    a[:n, :n], b[:n] = generator[:n, :n] / over, generator[:n, n] / over
    carried = [np.pad(found[1], (0, order))]
    for i in range(order):
        a[n + i], b[n + i] = carried[-1], 0.0 if i else direct
        carried.append(np.eye(n + order)[n + i])
    staying = bool(np.any(abs(np.linalg.eigvals(a[:n, :n])) < leak))
    a -= leak * np.diag(np.arange(n + order) >= (0 if staying else n))
    flow = carried[-2] if order else carried[-1] @ a
    at_once = float(carried[-1] @ b) if not order else direct if order == 1 else 0.0
    return a, expm(a * step), b, np.stack([carried[-1], flow]), np.array([0.0, at_once])


@dataclass(frozen=True, eq=False)
class LinearisedInTime:
    """The force φ = s_q q + s_v q̇ (M, N) of slopes that vary over a grid, where it acts back on the plants.

        w⁺ = w − B ψ,   ψ = h φ at the mean of w and w⁺,   w_{k+1} = e^{Ah} w⁺

    Forces are impulses on the grid, so that all steps are a `Recursion`, and the states are those of a period.
    """

    plants: PlantsInTime
    by_displacement: FloatArray
    by_flow: FloatArray

    @cached_property
    def _row(self) -> FloatArray:
        """What w adds to φ, (n, M, N)."""
        q, flow = self.plants.motion[..., None]
        return np.asarray(self.by_displacement * q + self.by_flow * flow)

    @cached_property
    def _yielding(self) -> FloatArray:
        """By what the force is less than without its own effect on the motion it sees, (M, N)."""
        entry, plants = self.plants.entry[..., None], self.plants
        at_once = self.by_displacement * plants.direct[0, :, None] + self.by_flow * plants.direct[1, :, None]
        own = 0.5 * plants.step * np.sum(self._row * entry, axis=0) + at_once
        return np.asarray(1 / np.maximum(1 + own, LEAST))

    @cached_property
    def _recursion(self) -> Recursion:
        n, count = len(self.plants.entry), self._row.shape[-1]
        pushed = -self.plants.step * self.plants.entry[:, None, :, None] * (self._row * self._yielding)[None]
        kept = pushed + np.eye(n)[:, :, None, None]
        steps = np.zeros((n, n, self._row.shape[1], 1 << (count - 1).bit_length()))
        steps[..., :count] = [[_row_times(self.plants.transition[i], kept[:, j]) for j in range(n)] for i in range(n)]
        steps[..., count:] = np.eye(n)[:, :, None, None]
        return Recursion(steps)

    @property
    def growth(self) -> FloatArray:
        """By how much a small change of the states is larger a period later, at most, (M,): Floquet's multipliers."""
        whole = np.moveaxis(self._recursion.whole, -1, 0)
        return np.asarray(
            abs(np.linalg.eigvals(whole)).max(axis=1) if np.all(np.isfinite(whole)) else np.full(len(whole), np.inf)
        )

    def force(self, unyielding: FloatArray) -> FloatArray:
        """φ (…, M, N) for what it would be if the motion did not react to it, (…, M, N)."""
        count, total = unyielding.shape[-1], self._recursion.steps.shape[-1]
        pushed = -self.plants.step * self._yielding * unyielding
        driven = np.zeros((len(self.plants.entry), *unyielding.shape[:-1], total))
        for i, row in enumerate(self.plants.transition):
            driven[i, ..., :count] = np.sum(row * self.plants.entry, axis=0)[:, None] * pushed
        states = self._recursion.states(driven)[..., :count]
        seen = sum((self._row[i] * states[i] for i in range(1, len(states))), self._row[0] * states[0])
        return np.asarray((unyielding + seen) * self._yielding)


def _row_times(row: FloatArray, columns: FloatArray) -> FloatArray:
    """Σ_j row_j column_j (M, N) for row (n, M) and columns (n, M, N)."""
    return np.asarray(np.sum(row[..., None] * columns, axis=0))
