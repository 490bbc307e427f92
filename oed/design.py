"""Least-energy experiments with a certificate [Ghosh2018, (17), (19)]."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.outcome import Outcome
from identification.signals import OperatingPoint
from oed.box import refine_over_box
from oed.column_generation import CertifiedSpectra, Progress, Shortfall, least_energy
from oed.decisions import Decision
from oed.duration import required_samples, supplementary_points
from oed.information import noise_information, require_stable
from oed.pencil import covariance_of, shares
from oed.problem import DesignProblem
from oed.scaling import ScaledProblem, scaled
from oed.spectra.family import Spectrum
from oed.spectra.multisines import MultisinePricing, Multisines, MultisineSpectrum
from oed.statement import Statement, stated
from oed.whole_periods import whole_periods

COVERED = 1e-9
MET = 1e-6
WHOLE = 0.01
MOST_NAMED = 3
NAMED = 0.05


@dataclass(frozen=True, eq=False)
class DesignedExperiment:
    """One local experiment: where, with how much energy Σ_t u(t)², and with which spectrum."""

    operating_point: OperatingPoint
    energy: float
    spectrum: Spectrum


@dataclass(frozen=True)
class Binding:
    """What holds the energy up: the `index`-th target, cap or limit, a cap or limit at the `point`-th operating point.

    `multiplier` is, for a target, how much the energy grows per unit of growth of R (relative to both); for a cap, the
    energy that one unit of a higher cap would save; for a limit, how much energy a unit of growth of the mean square
    that it allows would save (relative to both).
    """

    what: Literal["target", "cap", "limit"]
    index: int
    multiplier: float
    point: int | None = None


@dataclass(frozen=True, eq=False)
class Design:
    """The experiments to do, and how good they are certified to be.

    `total_energy` J is that of the experiments. `least_energy` is the same except where only whole periods can be
    played, there that of parts of periods; `lower_bound`: nothing that the family can play at any of the allowed points
    meets the targets with less; `gap` = 1 − lower_bound / total_energy. `samples` N_p is the duration asked for, or the
    next above `required_samples` of rule (18); `expected_covariance` P (k, k) of θ_G, the parameters of the effects in
    the model, and θ_H, infinite for parameters that stay undetermined; `decisions`: what can be decided, by
    number of the target.
    """

    outcome: Outcome
    experiments: tuple[DesignedExperiment, ...]
    total_energy: float
    least_energy: float
    lower_bound: float
    gap: float
    samples: int
    required_samples: float
    expected_covariance: FloatArray
    binding: tuple[Binding, ...]
    decisions: tuple[tuple[int, Decision], ...] = ()


@dataclass(frozen=True, eq=False)
class _Found:
    """What the solver found for a statement: experiments, energies, what they tell about the hypotheses (K, K)."""

    experiments: tuple[DesignedExperiment, ...]
    energy: float
    least_energy: float
    lower_bound: float
    learnt: FloatArray
    binding: tuple[Binding, ...]
    solver_gap: float
    iterations: int


def design(problem: DesignProblem, progress: Progress | None = None) -> Design:
    """The operating points and input spectra of least energy that guarantee the accuracy asked for.

        min J = Σ_m E_m   s.t.   P_θ⁻¹ ⪰ R_j for every target,   E_m ≤ α_m                 [Ghosh2018, (17), (19)]

    Decisions about effects are such targets too, each about parameters of a hypothesis of its own. An accuracy that
    cannot be reached gives the status "infeasible" and advice on what to change; raises MisuseError when the model is
    unstable at a point or the targets do not fit the model.
    """
    require_stable(problem.model, problem.points)
    if problem.box and isinstance(problem.family, Multisines):
        raise MisuseError("candidate multisines need operating points to choose from; give a grid", "points")
    return designed(problem, stated(problem), progress)


def designed(problem: DesignProblem, statement: Statement, progress: Progress | None = None) -> Design:
    """The design of a problem whose matrices are known."""
    k = statement.plant
    nothing = np.zeros((k, k))
    known = shares(statement.prior[:k, :k], nothing, statement.targets[:, :k, :k])
    asking = np.flatnonzero(known > 1 + COVERED)
    if len(asking) == 0:
        return _described(problem, statement, _Found((), 0.0, 0.0, 0.0, nothing, (), 0.0, 0))
    problem_scaled = scaled(problem, statement, asking)
    if isinstance(problem_scaled, Outcome):
        return _unreachable(problem, problem_scaled)
    solution, problem_scaled = _solved(problem_scaled, progress)
    if isinstance(solution, Shortfall):
        return _unreachable(problem, _shortfall_advice(problem_scaled, solution))
    if not solution.blocks:
        advice = "the solver found no spectra that meet the targets; relax the narrowest of the targets or the caps"
        return _unreachable(problem, Outcome("not_converged", advice, solution.iterations))
    return _described(problem, statement, _found(problem_scaled, solution))


def _found(problem: ScaledProblem, solution: CertifiedSpectra) -> _Found:
    played, pricing, unit = solution, problem.pricing, problem.unit
    if isinstance(pricing, MultisinePricing):
        in_unit = replace(pricing, energies=pricing.energies / unit)
        played = whole_periods(in_unit, solution, problem.targets, problem.caps, problem.tolerance)
    return _Found(
        _experiments(problem, played),
        unit * played.energy,
        unit * solution.energy,
        unit * played.lower_bound,
        problem.information(played.blocks, played.weights),
        _binding(problem, solution),
        max(solution.gap, 0.0),
        solution.iterations,
    )


def _solved(problem: ScaledProblem, progress: Progress | None) -> tuple[CertifiedSpectra | Shortfall, ScaledProblem]:
    solution = least_energy(problem.pricing, problem.targets, problem.caps, problem.tolerance, progress=progress)
    if problem.original.box and isinstance(solution, CertifiedSpectra):
        return refine_over_box(problem, solution, progress)
    return solution, problem


def _experiments(problem: ScaledProblem, solution: CertifiedSpectra) -> tuple[DesignedExperiment, ...]:
    experiments = []
    for m in sorted({block.point for block in solution.blocks}, key=lambda m: (*problem.points[m], m)):
        own = [
            (block, weight * problem.unit)
            for block, weight in zip(solution.blocks, solution.weights, strict=True)
            if block.point == m
        ]
        spectrum = problem.pricing.spectrum([block for block, _ in own], [weight for _, weight in own])
        if spectrum.energy > 0:
            point = tuple(float(value) for value in problem.points[m])
            experiments.append(DesignedExperiment(point, spectrum.energy, spectrum))
    return tuple(experiments)


def _binding(problem: ScaledProblem, solution: CertifiedSpectra) -> tuple[Binding, ...]:
    by_target = np.zeros(len(problem.original.targets))
    numbers = {int(j): n for n, j in enumerate(problem.asking)}
    for target, j, rows in problem.statement.parts:
        if j in numbers and solution.prices[numbers[j]].any():
            here = np.ix_(inside := problem.inside(rows), inside)
            worth = np.sum(problem.targets[numbers[j]][here] * solution.prices[numbers[j]][here])
            by_target[target] += float(worth) / solution.energy
    targets = [Binding("target", int(i), float(by_target[i])) for i in np.flatnonzero(by_target > 1e-4)]
    places = problem.pricing.places
    caps = [
        Binding("cap", int(places[m]), float(solution.cap_prices[m]), int(places[m]))
        for m in np.flatnonzero(solution.cap_prices > 1e-4)
    ]
    relative = solution.tolls / solution.energy
    limits = [
        Binding("limit", number, float(relative[number, m]), int(places[m]))
        for number, m in np.argwhere(relative > 1e-4).tolist()
    ]
    return (*targets, *caps, *limits)


def _described(problem: DesignProblem, statement: Statement, found: _Found) -> Design:
    k = statement.plant
    gap = _gap(found.lower_bound, found.energy)
    points = np.array([one.operating_point for one in found.experiments]).reshape(-1, problem.points.shape[1])
    per_sample = noise_information(problem.model, points)
    noise_targets, noise_prior = statement.targets[:, k:, k:], statement.prior[k:, k:]
    needed = required_samples(per_sample, noise_targets, noise_prior)
    samples = max(problem.samples, int(np.floor(needed)) + 1) if np.isfinite(needed) else problem.samples
    learnt = np.zeros_like(statement.prior)
    learnt[:k, :k] = found.learnt
    lengths = np.array([_length(one.spectrum, samples) for one in found.experiments])
    learnt[k:, k:] = np.tensordot(lengths, per_sample, axes=1)
    own = np.ix_(statement.own, statement.own)
    if np.isfinite(needed):
        outcome = _held(statement, learnt, _outcome(problem, found))
    else:
        known = noise_prior + per_sample.sum(axis=0)
        outcome = _noise_undetermined(problem, known, noise_targets)
    return Design(
        outcome,
        found.experiments,
        float(found.energy),
        float(found.least_energy),
        float(found.lower_bound),
        float(gap),
        samples,
        needed,
        covariance_of(statement.prior[own], learnt[own]),
        found.binding,
        statement.decisions(statement.prior + learnt),
    )


def _length(spectrum: Spectrum, samples: int) -> int:
    return spectrum.periods * spectrum.samples if isinstance(spectrum, MultisineSpectrum) else samples


def _held(statement: Statement, learnt: FloatArray, outcome: Outcome) -> Outcome:
    """The outcome, unless a target is not met by what the experiments tell in all."""
    plant, noise = (slice(None, statement.plant),) * 2, (slice(statement.plant, None),) * 2
    if np.any(shares(statement.prior[noise], learnt[noise], statement.targets[:, *noise]) > 1 + MET):
        advice = "the designed periods are too short for the noise model; record without input as well"
        return Outcome("infeasible", advice, outcome.iterations)
    missed = np.flatnonzero(shares(statement.prior[plant], learnt[plant], statement.targets[:, *plant]) > 1 + MET)
    if len(missed):
        number = next(target for target, j, _ in statement.parts if j in missed)
        advice = (
            f"the experiments found do not meet target {number + 1}: it asks for something that they hardly tell"
            " anything about; allow more operating points or frequencies, or relax it"
        )
        return Outcome("not_converged", advice, outcome.iterations)
    return outcome


def _noise_undetermined(problem: DesignProblem, known: FloatArray, targets: FloatArray) -> Outcome:
    further = supplementary_points(noise_information(problem.model, problem.points), known, targets)
    where = "; ".join(", ".join(f"{value:g}" for value in problem.points[m]) for m in further)
    remedy = f"record without input at ({where}) as well" if further else "allow more operating points"
    return Outcome("infeasible", f"the designed experiments cannot determine the noise model: {remedy}")


def _outcome(problem: DesignProblem, found: _Found) -> Outcome:
    if found.solver_gap > problem.tolerance:
        advice = (
            f"a gap of {found.solver_gap:.1e} remains; the experiments meet the targets, but could take that much less"
            " energy"
        )
        return Outcome("not_converged", advice, found.iterations)
    gap, advice = _gap(found.lower_bound, found.energy), ""
    if gap > max(WHOLE, problem.tolerance):
        advice = (
            f"only whole periods can be played: other numbers of them might take up to {100 * gap:.2g} % less energy"
        )
    return Outcome("converged", advice, found.iterations)


def _gap(lower_bound: float, energy: float) -> float:
    return max(1 - lower_bound / energy, 0.0) if energy > 0 else 0.0


def _shortfall_advice(problem: ScaledProblem, shortfall: Shortfall) -> Outcome:
    share = 1 - shortfall.least
    looser = f"relax all standard deviations by a factor {_rounded_up(share**-0.5):g}, or " if share > 0 else ""
    limited = bool(problem.original.plant_limits)
    under = "the energy caps and limits" if limited else "the energy caps"
    return Outcome(
        "infeasible",
        f"under {under} at most {100 * share:.3g} % of the information asked for can be reached"
        f"{_in_the_way(problem, shortfall) if limited else ''}: {looser}raise the {'limits' if limited else 'caps'},"
        " allow more operating points, samples or levels, or use prior experiments",
    )


def _in_the_way(problem: ScaledProblem, shortfall: Shortfall) -> str:
    """The limits and caps that cost most of what is missing, and by which factor all of them would have to grow.

    Scaling all by κ scales what can be learnt, so κ (1 − t) = 1 for the least share t that is missing.
    """
    paid = np.vstack([shortfall.tolls, shortfall.cap_prices])
    words = [*(limit.words for limit in problem.original.plant_limits), "the energy cap"]
    most = [divmod(int(i), paid.shape[1]) for i in np.argsort(-paid, axis=None)[:MOST_NAMED]]
    named = [
        f"{words[number]} at ({', '.join(f'{value:g}' for value in problem.points[m])})"
        for number, m in most
        if paid[number, m] > NAMED * paid.sum()
    ]
    factor = 1 / max(1 - shortfall.least, 1e-12)
    grown = f" (power × {_rounded_up(factor):g}, with all others alike, would do)"
    return f"; in the way: {'; '.join(named)}{grown}"


def _rounded_up(factor: float) -> float:
    """Three significant digits of a factor above one, and more than one."""
    step = 10.0 ** (np.floor(np.log10(factor)) - 2)
    return max(float(np.ceil(factor / step - 1e-9) * step), 1.001)


def _unreachable(problem: DesignProblem, outcome: Outcome) -> Design:
    noise = problem.model.noise_size
    k = len(problem.model.parameters) + noise
    nothing = np.full((k, k), np.inf)
    return Design(outcome, (), np.inf, np.inf, np.inf, np.inf, problem.samples, np.inf, nothing, ())
