"""A design problem in matrices: what is to be known, what is known, and which target asks for which part."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.comparison.batch import Batch
from identification.models.model import Model
from oed.decisions import Decision, Demand
from oed.hypothesis import Hypothesis
from oed.problem import DecisionTarget, DesignProblem
from oed.spectra.family import Pricing
from oed.subject import Subject


@dataclass(frozen=True, eq=False)
class Statement:
    """The matrices R_j (J, K, K) of a problem and its prior information (K, K).

    K: the parameters of all hypotheses one after another, then θ_H. `parts`: for each share of a matrix the target that
    it belongs to, its j and its rows. `demands`: of the decisions, with their targets and rows. `pricing`: the spectra
    that there are at the operating points of the problem.
    """

    subject: Subject
    targets: FloatArray
    prior: FloatArray
    parts: tuple[tuple[int, int, slice], ...]
    demands: tuple[tuple[int, slice, Demand], ...]
    pricing: Pricing

    @property
    def plant(self) -> int:
        """Number of parameters of the hypotheses."""
        return self.subject.size

    @property
    def own(self) -> IntArray:
        """Where the parameters of the model itself stand: θ_G, those of its effects, θ_H."""
        first = self.subject.hypotheses[0].size
        return np.concatenate([np.arange(first), np.arange(self.plant, len(self.prior))])

    def asking(self, share: float) -> "Statement":
        """The same for this share of the information that the targets ask for."""
        return replace(self, targets=share * self.targets)

    def decisions(self, information: FloatArray) -> tuple[tuple[int, Decision], ...]:
        """What information (K, K) allows to decide, by target."""
        return tuple((i, demand.expected(information[rows, rows])) for i, rows, demand in self.demands)


def stated(problem: DesignProblem) -> Statement:
    """The matrices of a problem; raises MisuseError where targets do not fit the model."""
    model = problem.model
    demands = _demands(problem)
    itself = Hypothesis(model)
    others = [demand.hypothesis for _, demand in demands]
    subject = Subject((itself, *others))
    noise = model.noise_size
    size = subject.size + noise
    base = _base_places(model, subject.size)
    matrices: list[FloatArray] = []
    parts: list[tuple[int, int, slice]] = []
    for i, target in enumerate(problem.targets):
        if isinstance(target, DecisionTarget):
            continue
        for matrix in target.matrices(model):
            parts.append((i, len(matrices), slice(0, size)))
            matrices.append(_embedded(matrix, base, size))
    placed = [(i, rows, demand) for (i, demand), rows in zip(demands, subject.slices[1:], strict=True)]
    if placed:
        parts += [(i, len(matrices), rows) for i, rows, _ in placed]
        together = np.zeros((size, size))
        for _, rows, demand in placed:
            together[rows, rows] = demand.matrix
        matrices.append(together)
    pricing = problem.family.pricing(subject, problem.points, problem.band, problem.step)
    return Statement(subject, np.stack(matrices), _prior(problem, subject, size), tuple(parts), tuple(placed), pricing)


def _demands(problem: DesignProblem) -> list[tuple[int, Demand]]:
    deciding = [(i, target) for i, target in enumerate(problem.targets) if isinstance(target, DecisionTarget)]
    if not deciding:
        return []
    reference, measured = _reference(problem)
    return [(i, demand) for i, target in deciding for demand in target.demands(problem.model, reference, measured)]


def _reference(problem: DesignProblem) -> tuple[Sequence[Batch], bool]:
    if problem.prior_experiments:
        return problem.prior_experiments, True
    return problem.family.reference(problem.model, problem.points, problem.band, problem.step), False


def _base_places(model: Model, plant: int) -> IntArray:
    """Where θ_G and θ_H stand."""
    k, noise = model.plant_size, model.noise_size
    return np.concatenate([np.arange(k), plant + np.arange(noise)])


def _embedded(matrix: FloatArray, places: IntArray, size: int) -> FloatArray:
    if len(places) == size:
        return matrix
    result = np.zeros((size, size))
    result[np.ix_(places, places)] = matrix
    return result


def _prior(problem: DesignProblem, subject: Subject, size: int) -> FloatArray:
    """What is known about the model itself, or what earlier experiments tell about every hypothesis."""
    prior = np.zeros((size, size))
    own = np.concatenate([np.arange(subject.hypotheses[0].size), np.arange(subject.size, size)])
    prior[np.ix_(own, own)] = problem.prior
    if problem.prior_experiments:
        prior[: subject.size, : subject.size] += subject.information(problem.prior_experiments)
    return prior
