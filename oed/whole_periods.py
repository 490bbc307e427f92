"""From parts of periods to whole ones."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, OptimizeResult, milp

from identification.arrays import FloatArray, IntArray
from oed.column_generation import CertifiedSpectra, needed_scale
from oed.spectra.multisines import LEAST_PERIODS, MultisinePricing

MET = 1e-9
ROUNDS = 40
MOST_NODES = 20
SOLVED = 0
SEMI_INTEGER = 3
CLOSE = 1e-9


def whole_periods(
    pricing: MultisinePricing, solution: CertifiedSpectra, targets: FloatArray, limits: FloatArray, tolerance: float
) -> CertifiedSpectra:
    """Every experiment with whole periods, none or at least two, that meet the targets R_j (J, k, k), and their bound.

        min Σ_c e_c n_c   s.t.   Σ_c n_c I_c ⪰ R_j for all j,   n_c ∈ {0} ∪ {2, 3, …, most_c}

    Every price Z ⪰ 0 gives the cut Σ_c n_c tr Z I_c ≥ tr Z R_j. The integer programme with the cuts found so far bounds
    the energy from below; where its answer misses a target, the direction that is missed most is the next cut [outer
    approximation, DuranGrossmann1986]. Each answer, and the parts of periods, rounded up and then taken away one by one
    as long as the targets stay met, bound it from above. What remains between the bounds when the integer programmes
    become large is told.
    """
    start = solution.lower_bound
    programme = _Programme.of(pricing, solution, targets, limits)
    best, bound = programme.rounded(pricing.counts(solution.blocks, solution.weights)), start
    programme = programme.without_idle(programme.energy(best), solution.prices)
    for _ in range(ROUNDS):
        if programme.energy(best) - bound <= tolerance * programme.energy(best):
            break
        answer = programme.relaxed()
        if answer.mip_dual_bound is not None and np.isfinite(answer.mip_dual_bound):
            bound = max(bound, float(answer.mip_dual_bound))
        if answer.x is None or answer.status != SOLVED:
            break
        counts = np.rint(answer.x)
        trial = programme.rounded(counts)
        best = trial if programme.energy(trial) < programme.energy(best) else best
        programme = programme.cut(counts)
    return _played(pricing, solution, best, min(bound, programme.energy(best)))


@dataclass(frozen=True, eq=False)
class _Programme:
    """Information (C, k, k) and energies (C,) of one period, the most periods (C,), and cuts rows · n ≥ 1 (Q, C)."""

    information: FloatArray
    energies: FloatArray
    targets: FloatArray
    most: FloatArray
    cuts: FloatArray

    @classmethod
    def of(
        cls, pricing: MultisinePricing, solution: CertifiedSpectra, targets: FloatArray, limits: FloatArray
    ) -> "_Programme":
        energies = pricing.energies
        most = np.maximum(np.rint(limits / energies), LEAST_PERIODS)
        nothing = np.zeros((0, len(energies)))
        programme = cls(pricing.information * energies[:, None, None], energies, targets, most, nothing)
        for price, target in zip(solution.prices, targets, strict=True):
            programme = programme._with(price, target)
        return programme

    def energy(self, counts: FloatArray) -> float:
        """Σ e_c n_c; infinite where a target is missed."""
        met = counts.any() and needed_scale(self._total(counts), self.targets) <= 1 + MET
        return float(counts @ self.energies) if met else np.inf

    def without_idle(self, energy: float, prices: FloatArray) -> "_Programme":
        """Without the candidates of which two periods, at these prices Z (J, k, k), take more than this energy."""
        worth = np.einsum("cij,ij->c", self.information, prices.sum(axis=0)) / self.energies
        scale = 1 / max(float(worth.max()), 1e-300)
        bound = scale * float(np.einsum("jab,jab", prices, self.targets))
        idle = bound + LEAST_PERIODS * self.energies * (1 - scale * worth) > energy * (1 + MET)
        return replace(self, most=np.where(idle, 0.0, self.most))

    def relaxed(self) -> OptimizeResult:
        """The integer programme with the cuts so far."""
        return milp(
            self.energies,
            integrality=np.full(len(self.energies), SEMI_INTEGER),
            bounds=Bounds(np.minimum(LEAST_PERIODS, self.most), self.most),
            constraints=LinearConstraint(self.cuts, np.ones(len(self.cuts)), np.inf),
            options={"node_limit": MOST_NODES, "mip_rel_gap": CLOSE},
        )

    def cut(self, counts: FloatArray) -> "_Programme":
        """With the direction v of each target that these periods miss most: Σ_c n_c vᵀ I_c v ≥ vᵀ R_j v."""
        values, vectors = np.linalg.eigh(self.targets - self._total(counts))
        programme = self
        for j in np.argsort(-values[:, -1])[:3]:
            if values[j, -1] > 0:
                direction = vectors[j][:, -1]
                programme = programme._with(np.outer(direction, direction), self.targets[j])
        return programme

    def rounded(self, counts: FloatArray) -> FloatArray:
        """Whole periods that meet the targets, from numbers that nearly do; with none idle."""
        total = self._total(counts)
        scale = needed_scale(total, self.targets)
        grown = np.ceil(counts * (scale if np.isfinite(scale) else 1.0) - 1e-6)
        whole = np.where(counts > 0, np.clip(grown, LEAST_PERIODS, self.most), 0.0)
        return self._fewer(whole) if np.isfinite(self.energy(whole)) else whole

    def _fewer(self, counts: FloatArray) -> FloatArray:
        """Periods taken away, the dearest first, where all targets stay met."""
        order: IntArray = np.argsort(-self.energies, kind="stable")
        changed = True
        while changed:
            changed = False
            for i in order[counts[order] > 0]:
                trial = counts.copy()
                trial[i] = trial[i] - 1 if trial[i] > LEAST_PERIODS else 0.0
                if np.isfinite(self.energy(trial)):
                    counts, changed = trial, True
        return counts

    def _with(self, price: FloatArray, target: FloatArray) -> "_Programme":
        asked = float(np.sum(price * target))
        if asked <= 0:
            return self
        row = np.einsum("cij,ij->c", self.information, price) / asked
        return replace(self, cuts=np.vstack([self.cuts, row]))

    def _total(self, counts: FloatArray) -> FloatArray:
        used = np.flatnonzero(counts)
        return np.asarray(np.tensordot(counts[used], self.information[used], axes=1))


def _played(
    pricing: MultisinePricing, solution: CertifiedSpectra, counts: FloatArray, bound: float
) -> CertifiedSpectra:
    kept = np.flatnonzero(counts)
    energies = counts[kept] * pricing.energies[kept]
    return replace(
        solution,
        blocks=[pricing.block(c) for c in kept.tolist()],
        weights=[np.full((1, 1), energy) for energy in energies],
        energy=float(energies.sum()),
        lower_bound=max(bound, solution.lower_bound),
    )
