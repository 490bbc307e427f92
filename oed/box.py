"""Operating points free in the whole range of the scheduling variables."""

from dataclasses import replace

import numpy as np

from identification.arrays import FloatArray
from oed.column_generation import CertifiedSpectra, Progress, least_energy
from oed.scaling import ScaledProblem

AUDIT_POINTS = 400
ZOOMS = 6
MERGED_WITHIN = 0.02


def refine_over_box(
    problem: ScaledProblem, solution: CertifiedSpectra, progress: Progress | None
) -> tuple[CertifiedSpectra, ScaledProblem]:
    """Adds operating points where a spectrum is worth more than it costs, until there is none left in the box.

    Neighbouring points are then merged where that keeps the gap. The lower bound holds for the points of an audit grid
    (400 for one scheduling variable) and for the maxima found between them.
    """
    audit = _Audit(problem)
    for _ in range(20):
        better, bound = audit.held_against(solution)
        if 1 - bound / solution.energy <= problem.tolerance:
            break
        problem, solution = _resolved(problem, solution, _distinct(np.vstack([problem.points, better])), progress)
    solution = replace(solution, lower_bound=bound)
    return _merged(problem, solution)


def _resolved(
    problem: ScaledProblem, solution: CertifiedSpectra, points: FloatArray, progress: Progress | None = None
) -> tuple[ScaledProblem, CertifiedSpectra]:
    """The design on these points, of which the first are those of the problem so far."""
    caps = np.full(len(points), np.inf)
    blocks = solution.blocks if len(points) >= len(problem.points) else ()
    problem = replace(problem, points=points, caps=caps, pricing=problem.priced(points))
    found = least_energy(problem.pricing, problem.targets, caps, problem.tolerance, progress=progress, blocks=blocks)
    if not isinstance(found, CertifiedSpectra):
        raise AssertionError("without caps the targets can always be met")
    return problem, found


def _merged(problem: ScaledProblem, solution: CertifiedSpectra) -> tuple[CertifiedSpectra, ScaledProblem]:
    """With neighbouring points replaced by their centre of energy, if the gap stays within the tolerance."""
    used = sorted({block.point for block in solution.blocks})
    energies = np.zeros(len(problem.points))
    np.add.at(energies, [block.point for block in solution.blocks], [np.trace(weight) for weight in solution.weights])
    extent = np.ptp(_limits(problem), axis=0)
    groups: list[list[int]] = []
    for m in sorted(used, key=lambda m: tuple(problem.points[m])):
        near = bool(groups) and np.all(
            abs(problem.points[m] - problem.points[groups[-1][-1]]) <= MERGED_WITHIN * extent
        )
        groups[-1].append(m) if near else groups.append([m])
    centres = np.array([np.average(problem.points[group], axis=0, weights=energies[group]) for group in groups])
    if len(groups) == len(used):
        return solution, problem
    merged_problem, merged = _resolved(problem, solution, centres)
    merged = replace(merged, lower_bound=solution.lower_bound)
    return (merged, merged_problem) if merged.gap <= problem.tolerance else (solution, problem)


class _Audit:
    """A grid over the box on which the worth of spectra is looked at."""

    def __init__(self, problem: ScaledProblem) -> None:
        self.problem = problem
        self.lower, self.upper = _limits(problem)
        variables = len(self.lower)
        count = max(5, round((AUDIT_POINTS * variables) ** (1 / variables)))
        axes = [np.linspace(low, high, count) for low, high in zip(self.lower, self.upper, strict=True)]
        self.points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, variables)
        self.pricing = problem.priced(self.points)
        self.spacing = (self.upper - self.lower) / (count - 1)
        offsets = np.meshgrid(*[np.linspace(-1, 1, 5)] * variables, indexing="ij")
        self.offsets = np.stack(offsets, axis=-1).reshape(-1, variables)

    def held_against(self, solution: CertifiedSpectra) -> tuple[FloatArray, float]:
        """Points that are worth more than they cost, few and apart from each other, and the lower bound they leave."""
        prices = solution.prices.sum(axis=0)
        worth = self.pricing.best(prices, np.full(len(self.points), np.inf), (), ()).worth
        highest = max(float(worth.max()), 1.0)
        chosen: list[FloatArray] = []
        for index in np.argsort(worth)[::-1]:
            apart = all(np.any(abs(self.points[index] - other) > 2.5 * self.spacing) for other in chosen)
            if worth[index] > 1 and apart and len(chosen) < 6:
                chosen.append(self.points[index])
        for i, point in enumerate(chosen):
            chosen[i], top = self._climbed(prices, point)
            highest = max(highest, top)
        bound = float(np.einsum("jab,jab", solution.prices, self.problem.targets)) / highest
        return np.array(chosen).reshape(-1, len(self.lower)), bound

    def _climbed(self, prices: FloatArray, centre: FloatArray) -> tuple[FloatArray, float]:
        for zoom in range(ZOOMS):
            around = np.clip(centre + self.offsets * self.spacing / 2**zoom, self.lower, self.upper)
            worth = self.problem.priced(around).best(prices, np.full(len(around), np.inf), (), ()).worth
            centre = around[np.argmax(worth)]
        return centre, float(worth.max())


def _limits(problem: ScaledProblem) -> FloatArray:
    return np.array([[v.minimum, v.maximum] for v in problem.original.model.dependence.variables]).T


def _distinct(points: FloatArray) -> FloatArray:
    """The points in their order, without repetitions."""
    _, first = np.unique(np.round(points, 12), axis=0, return_index=True)
    return np.asarray(points[np.sort(first)])
