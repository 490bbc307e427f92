"""Designs that keep their promise over what is not known of the model that they are made from."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag
from scipy.special import betaincinv

from identification.arrays import FloatArray
from identification.errors import MisuseError, RangeError
from identification.models.model import Model
from identification.outcome import Outcome
from oed.column_generation import Progress
from oed.design import Design, DesignedExperiment, designed
from oed.duration import required_samples
from oed.hypothesis import Hypothesis
from oed.information import noise_information, require_stable, sensitivity
from oed.pencil import Pencil, covariance_of, shares
from oed.problem import DecisionTarget, DesignProblem
from oed.spectra.fir import FirSpectra, FirSpectrum
from oed.spectra.lines import LineSpectra, LineSpectrum
from oed.statement import Statement, stated
from oed.subject import Subject

MOST_ADDED = 3
NEAR = 0.01
MET = 1e-6
OVER = 1e-3
SMOOTH = 1024
CONFIDENCE = 0.95
MOST_UNSTABLE = 0.5


@dataclass(frozen=True)
class Promise:
    """With which `probability` the targets are to be met at the true parameters, and how that is found and checked.

    The parameters are drawn from N(θ̂, P_θ), and σ_e² with the relative standard deviation `noise_deviation` (as
    σ̂² χ²_ν/ν with ν = 2/deviation²). `pool`: draws that the design is chosen with; `checked`: fresh draws that its
    promise is held against; `seed` of all of them.
    """

    probability: float = 0.95
    noise_deviation: float = 0.0
    pool: int = 600
    checked: int = 2000
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0.5 <= self.probability < 1:
            raise RangeError(f"the probability is {self.probability}; promise 0.5 or more, and less than 1", "promise")
        if not 0 <= self.noise_deviation < 1:
            raise RangeError("the relative deviation of the noise variance must lie between 0 and 1", "promise")
        if not (100 <= self.pool <= 10_000 and 100 <= self.checked <= 100_000):
            raise RangeError("choose with 100 to 10 000 draws, and check with 100 to 100 000", "promise")


@dataclass(frozen=True)
class Kept:
    """How a promise is kept: in `kept` of `checked` fresh draws, with an interval of 95 % [ClopperPearson1934].

    `scenarios`: the models that the certified problem holds at once, the estimate among them; `scenario_gap`: its gap;
    `scaling`: of its energies, so that the promised share of the pool is met; `unstable`: draws that were refused.
    """

    probability: float
    kept: int
    checked: int
    lowest: float
    highest: float
    scenarios: int
    scenario_gap: float
    scaling: float
    energy_at_estimate: float
    unstable: int


def promised(problem: DesignProblem, promise: Promise, progress: Progress | None = None) -> tuple[Design, Kept | None]:
    """The experiments that meet the targets with the promised probability, and how that was checked.

        min Σ_m E_m   s.t.   Π_s + M_s ⪰ R_s,j   for every scenario s and target j

    The scenarios are the estimate and draws from the covariance of the model, each with information of its own. Of the
    pool, the draw is added *at* the quantile promised, not the worst, until the design comes near; then all energies
    are scaled so that the promised share of the pool (and half a standard error more) and the estimate are met. Prior
    experiments tell each scenario what they tell at its parameters, stated prior information tells all the same.
    `lower_bound` and `gap` refer to the targets at the estimate alone, so that the gap holds the price of the promise.
    """
    _check(problem)
    require_stable(problem.model, problem.points)
    generator = np.random.default_rng(promise.seed)
    pool, unstable = _drawn(problem, promise, promise.pool, generator)
    first = found = designed(problem, stated(problem), progress)
    scenarios = [problem.model]
    while True:
        if not found.outcome.ok:
            return found, None
        needs = np.array([_needs(problem, found, one) for one in (problem.model, *pool)])
        scale, samples, reached = _enough(needs, promise, found.samples)
        if abs(scale - 1) <= NEAR or (scale == 0 and not found.experiments) or len(scenarios) > MOST_ADDED:
            break
        scenarios.append(pool[reached])
        found = designed(problem, _stated(problem, scenarios), progress)
    if not np.isfinite(scale) or not np.isfinite(samples):
        return _refused(found), None
    design = _scaled(problem, found, first.lower_bound, scale or 1.0, int(samples))
    fresh, _ = _drawn(problem, promise, promise.checked, generator)
    kept = sum(meets(problem, design, one) for one in fresh)
    lowest, highest = clopper_pearson(kept, promise.checked, CONFIDENCE)
    counts = (promise.probability, kept, promise.checked, lowest, highest, len(scenarios))
    return design, Kept(*counts, found.gap, scale or 1.0, first.total_energy, unstable)


def clopper_pearson(kept: int, trials: int, confidence: float) -> tuple[float, float]:
    """The exact interval of a probability of which `kept` of `trials` is an estimate [ClopperPearson1934]."""
    tail = (1 - confidence) / 2
    low = 0.0 if kept == 0 else float(betaincinv(kept, trials - kept + 1, tail))
    high = 1.0 if kept == trials else float(betaincinv(kept + 1, trials - kept, 1 - tail))
    return low, high


def _check(problem: DesignProblem) -> None:
    if problem.model.effects or any(isinstance(target, DecisionTarget) for target in problem.targets):
        raise MisuseError("a promise over scenarios is made for plants without effects; leave it out", "promise")
    if not isinstance(problem.family, FirSpectra | LineSpectra) or problem.box:
        raise MisuseError("a promise needs FIR or line spectra on a grid of operating points", "promise")
    _spread(problem.model)


def _spread(model: Model) -> FloatArray:
    """P_θ; raises MisuseError where there is none."""
    if model.covariance is None or not np.any(np.diagonal(model.covariance) > 0):
        raise MisuseError("the model has no covariance from which parameters could be drawn", "promise")
    return model.covariance


def _drawn(
    problem: DesignProblem, promise: Promise, count: int, generator: np.random.Generator
) -> tuple[list[Model], int]:
    """Models that are stable at all points, and how many draws were not."""
    model = problem.model
    values, vectors = np.linalg.eigh(_spread(model))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    drawn: list[Model] = []
    refused = 0
    while len(drawn) < count:
        theta = model.theta + root @ generator.standard_normal(len(model.theta))
        variance = model.noise_variance
        if promise.noise_deviation > 0:
            freedom = 2 / promise.noise_deviation**2
            variance *= float(generator.chisquare(freedom)) / freedom
        one = replace(model, theta=theta, noise_variance=variance)
        stable = model.structure.stable(one.coefficients(problem.points))
        if not model.structure.is_discrete or bool(np.all(stable)):
            drawn.append(one)
        else:
            refused += 1
        if refused > 100 and refused > MOST_UNSTABLE * (refused + len(drawn)):
            raise MisuseError(
                "most models drawn from the covariance are unstable; measure more before promising anything", "promise"
            )
    return drawn, refused


def _stated(problem: DesignProblem, scenarios: Sequence[Model]) -> Statement:
    """The estimate's statement with the blocks of the other scenarios put between θ_G and θ_H."""
    itself = stated(problem)
    if len(scenarios) == 1:
        return itself
    subject = Subject(tuple(Hypothesis(one) for one in scenarios))
    k = problem.model.plant_size
    others = [_matrices(problem, one)[:, :k, :k] for one in scenarios[1:]]
    targets = np.stack(
        [block_diag(own[:k, :k], *(other[j] for other in others), own[k:, k:]) for j, own in enumerate(itself.targets)]
    )
    known = [_prior(problem, one) for one in scenarios[1:]]
    prior = np.asarray(block_diag(itself.prior[:k, :k], *known, itself.prior[k:, k:]))
    parts = tuple((target, j, slice(0, len(prior))) for target, j, _ in itself.parts)
    pricing = problem.family.pricing(subject, problem.points, problem.band, problem.step)
    return Statement(subject, targets, prior, parts, (), pricing)


def _prior(problem: DesignProblem, model: Model) -> FloatArray:
    """What is known of θ_G before the experiments if this is the plant, (k, k)."""
    k = problem.model.plant_size
    told = problem.prior[:k, :k]
    return told + Subject.of(model).information(problem.prior_experiments) if problem.prior_experiments else told


def _matrices(problem: DesignProblem, model: Model) -> FloatArray:
    """R_j of all targets if this is the plant, (J, k, k)."""
    return np.concatenate([one.matrices(model) for one in problem.targets if not isinstance(one, DecisionTarget)])


def _needs(problem: DesignProblem, found: Design, model: Model) -> tuple[float, float]:
    """By which factor the energies, and to how many samples the length, must grow if this is the plant."""
    k, targets = model.plant_size, _matrices(problem, model)
    scale = Pencil.of(_prior(problem, model), _learnt(problem, found, model)).least(targets[:, :k, :k])
    heard = noise_information(model, _points(problem, found))
    return scale, required_samples(heard, targets[:, k:, k:], problem.prior[k:, k:])


def meets(problem: DesignProblem, found: Design, model: Model) -> bool:
    """Whether the experiments meet all targets if this is the plant."""
    k, targets = model.plant_size, _matrices(problem, model)
    heard = found.samples * noise_information(model, _points(problem, found)).sum(axis=0)
    plant = shares(_prior(problem, model), _learnt(problem, found, model), targets[:, :k, :k])
    noise = shares(problem.prior[k:, k:], heard, targets[:, k:, k:])
    return bool(np.all(plant <= 1 + MET) and np.all(noise <= 1 + MET))


def _points(problem: DesignProblem, found: Design) -> FloatArray:
    return np.array([one.operating_point for one in found.experiments]).reshape(-1, problem.points.shape[1])


def _learnt(problem: DesignProblem, found: Design, model: Model) -> FloatArray:
    """The information about θ_G that the experiments give if this is the plant, (k, k)."""
    nothing = np.zeros((model.plant_size,) * 2)
    return np.asarray(sum((_told(one, model, problem.step) for one in found.experiments), nothing))


def _told(experiment: DesignedExperiment, model: Model, step: float) -> FloatArray:
    """The information about θ_G that an experiment gives if this is the plant, (k, k)."""
    spectrum = experiment.spectrum
    assert isinstance(spectrum, LineSpectrum | FirSpectrum), "families that a promise is made for"
    samples = spectrum.samples if isinstance(spectrum, LineSpectrum) else max(SMOOTH, 8 * len(spectrum.coefficients))
    indices, energies = spectrum.line_energies(samples, step)
    omega = np.asarray(2 * np.pi * indices / (samples * step), dtype=np.float64)
    rows = sensitivity(model, [experiment.operating_point], omega)[0]
    return np.asarray(((rows.T * energies) @ rows.conj()).real)


def _enough(needs: FloatArray, promise: Promise, samples: int) -> tuple[float, float, int]:
    """Scale and samples that meet the estimate (first) and the promised share of the pool, and the draw at it."""
    pool = needs[1:]
    deviation = np.sqrt(promise.probability * (1 - promise.probability) / len(pool))
    share = min(promise.probability + deviation / 2, 1.0)
    order = np.argsort(pool[:, 0], kind="stable")
    for each in np.linspace(share, 1.0, 21):
        number = min(int(np.ceil(each * len(pool))), len(pool)) - 1
        scale = max(pool[order[number], 0], needs[0, 0])
        length = max(float(np.sort(pool[:, 1])[number]), float(needs[0, 1]), samples)
        if np.mean((pool[:, 0] <= scale) & (pool[:, 1] <= length)) >= share:
            break
    return float(scale), float(np.ceil(length)), int(order[number])


def _scaled(problem: DesignProblem, found: Design, bound: float, scale: float, samples: int) -> Design:
    """The design with all energies times a factor."""
    experiments = tuple(_times(one, scale) for one in found.experiments)
    energy = scale * found.total_energy
    k = problem.model.plant_size
    grown = replace(found, experiments=experiments)
    told = _learnt(problem, grown, problem.model)
    heard = samples * noise_information(problem.model, _points(problem, grown)).sum(axis=0)
    prior = np.asarray(block_diag(_prior(problem, problem.model), problem.prior[k:, k:]))
    broken = [
        one.operating_point
        for one in experiments
        for cap in problem.limits[np.all(problem.points == np.array(one.operating_point), axis=1)]
        if one.energy > cap * (1 + 1e-6)
    ]
    outcome = found.outcome
    over = next((one for one in experiments if problem.plant_limits and _over(problem, one, samples)), None)
    if over is not None:
        where = ", ".join(f"{value:g}" for value in over.operating_point)
        outcome = Outcome("infeasible", f"the promise would take more than the limits at ({where}) allow")
    if broken:
        where = ", ".join(f"{value:g}" for value in broken[0])
        outcome = Outcome("infeasible", f"the promise would take more energy than the cap at ({where}) allows")
    return replace(
        found,
        outcome=outcome,
        experiments=experiments,
        total_energy=energy,
        least_energy=energy,
        lower_bound=min(bound, energy),
        gap=max(1 - bound / energy, 0.0) if energy > 0 else 0.0,
        samples=samples,
        expected_covariance=covariance_of(prior, np.asarray(block_diag(told, heard))),
    )


def _over(problem: DesignProblem, experiment: DesignedExperiment, samples: int) -> bool:
    """Whether an experiment of so many samples takes more than a limit of the plant allows."""
    spectrum = experiment.spectrum
    period = spectrum.samples if isinstance(spectrum, LineSpectrum) else SMOOTH
    indices, energies = spectrum.line_energies(period, problem.step)
    omega = np.asarray(2 * np.pi * indices / (period * problem.step), dtype=np.float64)
    place = int(np.flatnonzero(np.all(problem.points == np.array(experiment.operating_point), axis=1))[0])
    shares = problem.share(omega)[:, place][:, energies > 0]
    return bool(np.any(shares @ energies[energies > 0] > samples * (1 + OVER)))


def _times(experiment: DesignedExperiment, scale: float) -> DesignedExperiment:
    spectrum = experiment.spectrum
    if isinstance(spectrum, LineSpectrum):
        return replace(
            experiment, energy=scale * experiment.energy, spectrum=replace(spectrum, energies=scale * spectrum.energies)
        )
    assert isinstance(spectrum, FirSpectrum), "families that a promise is made for"
    larger = replace(spectrum, coefficients=scale * spectrum.coefficients)
    return replace(experiment, energy=scale * experiment.energy, spectrum=larger)


def _refused(found: Design) -> Design:
    advice = "at some of the parameters that are likely, no energy or length is enough; measure more, or promise less"
    return replace(
        found,
        outcome=Outcome("infeasible", advice),
        experiments=(),
        total_energy=np.inf,
        least_energy=np.inf,
        lower_bound=np.inf,
        gap=np.inf,
        expected_covariance=np.full_like(found.expected_covariance, np.inf),
    )
