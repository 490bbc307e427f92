"""The certified solver: a small master problem, prices, better spectra, until no spectrum is worth more than it costs.

    primal   min Σ_m E_m   s.t.  Σ_m I_m ⪰ R_j for every target j,  E_m ≤ α_m,  ∫ w_l Φ_m ≤ 1 for every limit l
    dual     max Σ_j tr R_j Z_j − Σ_m α_m μ_m − Σ_lm ν_lm
             s.t.  ∫ (a* (Σ_j Z_j) a − Σ_l ν_lm w_l) Φ ≤ 1 + μ_m for every Φ of energy one at m

Here R_j stands for the part of the target that prior information does not yet cover.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray, IntArray
from oed.master import MasterSolution, solve_master
from oed.pencil import largest_eigenvalues
from oed.spectra.family import Block, Pricing

Progress = Callable[[int, float], None]
ACTIVE_TARGETS = 12
MOST_AT_START = 200
NEGLIGIBLE = 1e-3
REMEMBERED = 1e-4
CAP_SLACK = 1e-6
FEASIBLE = 1e-7
USED = 1e-9
BOUNDLESS = 1e6
LITTLE = 1e-4
DEARER = (0.0, 1e-7, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 1e-2, 0.1, 1.0)


@dataclass(frozen=True, eq=False)
class CertifiedSpectra:
    """Blocks with weights that meet the targets, and a lower bound on what any spectra of the family need."""

    blocks: list[Block]
    weights: list[FloatArray]
    prices: FloatArray
    cap_prices: FloatArray
    tolls: FloatArray
    energy: float
    lower_bound: float
    iterations: int

    @property
    def gap(self) -> float:
        """(energy − lower bound) / energy."""
        return (self.energy - self.lower_bound) / self.energy if self.energy > 0 else 0.0


@dataclass(frozen=True, eq=False)
class Shortfall:
    """No spectra under the caps and limits meet the targets: at most the share 1 − `least` of each R_j can be reached.

    `cap_prices` (M,) and `tolls` (L, M): what stands in the way, by how much less would be missing with a unit more.
    """

    least: float
    cap_prices: FloatArray
    tolls: FloatArray


def least_energy(
    pricing: Pricing,
    targets: FloatArray,
    caps: FloatArray,
    tolerance: float,
    max_iterations: int = 200,
    progress: Progress | None = None,
    blocks: Sequence[Block] = (),
) -> CertifiedSpectra | Shortfall:
    """The spectra of least energy for targets R_j (J, k, k) under caps α (M,), to a relative gap of `tolerance`.

    Limits are those of the blocks that the pricing makes (`Block.use`).

    `blocks` may bring spectra that are known to be useful; `progress` is told the iteration and the gap. The caller
    judges the gap: it may exceed `tolerance` after `max_iterations`. Good conditioning is the caller's: the information
    of flat spectra should be of the order of the unit matrix.
    """
    flat = pricing.flat()
    start = [*flat[:: 1 + len(flat) // MOST_AT_START], *blocks]
    bounded = bool(np.isfinite(caps).any()) or any(block.use is not None for block in start)
    if bounded:
        found = _within_caps(pricing, targets, caps, start)
        if isinstance(found, Shortfall):
            return found
        start = found
    feasible = start if bounded else []
    slow = False
    best = _Bounds(np.inf, 0.0, np.zeros_like(targets), np.zeros(len(caps)), np.zeros((0, len(caps))))
    active = np.arange(min(len(targets), ACTIVE_TARGETS))
    for iteration in range(1, max_iterations + 1):
        accuracy = 1e-8 if bounded else max(1e-8, 0.01 ** (iteration + 1))
        master = solve_master(start, targets[active], caps, accuracy=accuracy)
        weights = _remembered(master.weights, 100 * accuracy, slow)
        offer = pricing.best(master.prices.sum(axis=0), 1 + master.cap_prices, start, weights, master.tolls)
        earlier, best = best, best.improved(start, master, offer.worth, targets, active, caps)
        slow = best.gap > earlier.gap / 5
        if progress is not None:
            progress(iteration, best.gap)
        if best.gap <= tolerance / 4 or not master.solved:
            break
        active = _with_violated(active, start, master, targets)
        start = [*offer.blocks, *feasible]
    return best.sparse(targets, caps, tolerance, iteration)


@dataclass(frozen=True, eq=False)
class _Bounds:
    """The best feasible spectra and the best lower bound so far."""

    energy: float
    lower_bound: float
    prices: FloatArray
    cap_prices: FloatArray
    tolls: FloatArray
    blocks: Sequence[Block] = ()
    weights: Sequence[FloatArray] = ()

    @property
    def gap(self) -> float:
        return 1 - self.lower_bound / self.energy if np.isfinite(self.energy) and self.energy > 0 else 1.0

    def improved(
        self,
        blocks: Sequence[Block],
        master: MasterSolution,
        worth: FloatArray,
        targets: FloatArray,
        active: IntArray,
        caps: FloatArray,
    ) -> "_Bounds":
        value = float(np.einsum("jab,jab", master.prices, targets[active])) - float(master.tolls.sum())
        lower_bound = _dual_value(value, worth, caps)
        better = self
        if lower_bound > self.lower_bound:
            prices = np.zeros_like(targets)
            prices[active] = master.prices
            better = replace(
                better, lower_bound=lower_bound, prices=prices, cap_prices=master.cap_prices, tolls=master.tolls
            )
        return better.with_primal(blocks, master.weights, targets, caps)

    def with_primal(
        self, blocks: Sequence[Block], weights: Sequence[FloatArray], targets: FloatArray, caps: FloatArray
    ) -> "_Bounds":
        """These weights, scaled until they meet all targets, if that takes no more energy and breaks nothing."""
        scale = needed_scale(_total(blocks, weights), targets)
        energies = scale * _energies(blocks, weights, len(caps))
        if energies.sum() >= self.energy or np.any(energies > caps * (1 + CAP_SLACK)):
            return self
        if np.any(scale * _taken(blocks, weights, len(caps)) > 1 + CAP_SLACK):
            return self
        return replace(self, energy=energies.sum(), blocks=blocks, weights=[scale * weight for weight in weights])

    def sparse(self, targets: FloatArray, caps: FloatArray, tolerance: float, iterations: int) -> CertifiedSpectra:
        """Without operating points of negligible energy, as long as the gap stays within the tolerance."""
        if not self.blocks:
            paid = (self.prices, self.cap_prices, self.tolls)
            return CertifiedSpectra([], [], *paid, np.inf, self.lower_bound, iterations)
        energies = _energies(self.blocks, self.weights, len(caps))
        single = np.array([np.trace(weight) for weight in self.weights])
        used = np.array([energies[block.point] for block in self.blocks]) > NEGLIGIBLE * energies.max(initial=0.0)
        kept = np.flatnonzero(used & (single > NEGLIGIBLE * single.max(initial=0.0)))
        blocks = [self.blocks[i] for i in kept.tolist()]
        weights = [_semidefinite(self.weights[i]) for i in kept.tolist()]
        solution = replace(self, energy=np.inf).with_primal(blocks, weights, targets, caps)
        if solution.gap > tolerance and 0 < len(kept) < len(self.blocks):
            binding = np.argsort([-np.trace(price) for price in self.prices])[:ACTIVE_TARGETS]
            weights = [_semidefinite(w) for w in solve_master(blocks, targets[np.sort(binding)], caps).weights]
            solution = replace(self, energy=np.inf).with_primal(blocks, weights, targets, caps)
        if solution.gap > max(tolerance, self.gap):
            solution = self
        return CertifiedSpectra(
            list(solution.blocks),
            list(solution.weights),
            solution.prices,
            solution.cap_prices,
            solution.tolls,
            float(solution.energy),
            solution.lower_bound,
            iterations,
        )


def _within_caps(
    pricing: Pricing, targets: FloatArray, caps: FloatArray, blocks: list[Block]
) -> list[Block] | Shortfall:
    """Blocks with which the targets can be met under the caps, or how much is missing at least."""
    flat_energy = needed_scale(_total(blocks, [np.eye(len(block.shapes)) for block in blocks]), targets) * len(caps)
    limits = np.minimum(caps, BOUNDLESS * flat_energy)
    least = 0.0
    for _ in range(100):
        master = solve_master(blocks, targets, limits, shortfall_only=True)
        charges = master.cap_prices + LITTLE * _part(master) / limits.sum()
        offer = pricing.best(master.prices.sum(axis=0), charges, blocks, master.weights, master.tolls)
        if master.shortfall <= FEASIBLE:
            used = [block for block, weight in zip(blocks, master.weights, strict=True) if np.trace(weight) > USED]
            return [*used, *offer.blocks]
        value = float(np.einsum("jab,jab", master.prices, targets))
        least = value - _dearer(pricing, master, charges) * float(master.tolls.sum() + limits @ charges)
        exact = 1e-3 * _part(master)
        if least > FEASIBLE and master.shortfall - least <= exact:
            return Shortfall(least, master.cap_prices * limits, master.tolls)
        blocks = offer.blocks
    return Shortfall(max(least, 0.0), master.cap_prices * limits, master.tolls)


def _part(master: MasterSolution) -> float:
    """The smaller of the share that is missing and of the one that is reached."""
    return min(master.shortfall, max(1 - master.shortfall, FEASIBLE))


def _dearer(pricing: Pricing, master: MasterSolution, charges: FloatArray) -> float:
    """A factor on charges (M,) and tolls (L, M), one or little more, at which no spectrum is worth what it costs."""
    for excess in DEARER:
        charged = (1 + excess) * charges
        worth = pricing.best(master.prices.sum(axis=0), charged, (), (), (1 + excess) * master.tolls).worth
        if np.all(worth <= charged):
            return 1 + excess
    return np.inf


def _dual_value(value: float, worth: FloatArray, caps: FloatArray) -> float:
    """The best bound t (Σ tr R_j Z_j − Σ ν) − Σ_m α_m max(0, t worth_m − 1) over the scale t of the prices."""
    capped = np.isfinite(caps)
    highest = worth[~capped].max(initial=0.0)
    scales = 1 / worth[worth > 0]
    scales = scales[scales * highest <= 1 + 1e-12]
    charges = np.maximum(np.outer(scales, worth[capped]) - 1, 0.0) @ caps[capped]
    return float(np.max(scales * value - charges, initial=0.0))


def needed_scale(total: FloatArray, targets: FloatArray) -> float:
    """The least s with s · total ⪰ R_j for every j; infinite where the total cannot reach them."""
    values, vectors = np.linalg.eigh(total)
    root = vectors / np.sqrt(np.maximum(values, 1e-14 * max(values[-1], 1e-300)))
    return float(largest_eigenvalues(root.T @ targets @ root, relative=True).max())


def _remembered(weights: Sequence[FloatArray], least: float, everything: bool) -> list[FloatArray]:
    """Weights without blocks of less energy than `least`; with all directions of a block above zero if asked for.

    Directions of no weight are forgotten by the family, which keeps the master problem small; where progress is slow,
    they are worth remembering.
    """
    floor = REMEMBERED if everything else 0.0
    return [weight * (np.trace(weight) > least) + floor * np.eye(len(weight)) for weight in weights]


def _with_violated(active: IntArray, blocks: Sequence[Block], master: MasterSolution, targets: FloatArray) -> IntArray:
    """The active targets and those that the solution misses most."""
    if len(active) == len(targets):
        return active
    missing = largest_eigenvalues(targets - _total(blocks, master.weights), relative=False)
    missed = np.argsort(-missing)[: ACTIVE_TARGETS // 2]
    return np.union1d(active, missed[missing[missed] > 1e-9])


def _semidefinite(weight: FloatArray) -> FloatArray:
    values, vectors = np.linalg.eigh(weight)
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)


def _total(blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FloatArray:
    return np.asarray(sum(block.total(weight) for block, weight in zip(blocks, weights, strict=True)))


def _taken(blocks: Sequence[Block], weights: Sequence[FloatArray], points: int) -> FloatArray:
    """The share (M, L) of every limit that is taken at each point."""
    limits = 0 if not blocks or blocks[0].use is None else len(blocks[0].use)
    taken = np.zeros((points, limits))
    for block, weight in zip(blocks, weights, strict=True):
        taken[block.point] += block.taken(weight)
    return taken


def _energies(blocks: Sequence[Block], weights: Sequence[FloatArray], points: int) -> FloatArray:
    energies = np.zeros(points)
    np.add.at(energies, [block.point for block in blocks], [np.trace(weight) for weight in weights])
    return energies
