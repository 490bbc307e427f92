"""The loop, step by step: a first experiment, a model, a design, signals, a second experiment, a better model."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.demo import task
from app.demo.plant import AirHeater
from app.report.figures.accuracy import Accuracy
from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.estimates import LocalEstimate, LpvEstimate
from identification.likelihood import prediction_errors
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.outcome import Outcome
from identification.signals import FrequencyResponse, OperatingPoint, TimeRecord
from identification.spectral.periodic_average import PeriodicAverage
from oed.design import Design, design
from oed.problem import DesignProblem
from oed.realisation import RealisedSignal, realise
from oed.spectra.family import SpectrumFamily
from oed.spectra.fir import FirSpectra
from oed.spectra.lines import LineSpectra
from oed.targets.parameter_deviation import ParameterDeviation

Heard = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Campaign:
    """Records at several operating points, and the local model of each."""

    records: tuple[TimeRecord, ...]
    local: tuple[LocalEstimate, ...]

    @property
    def energy(self) -> float:
        """Σ u² over all records."""
        return float(sum(np.sum(record.input**2) for record in self.records))

    @property
    def points(self) -> tuple[OperatingPoint, ...]:
        """The operating points in order."""
        return tuple(record.operating_point for record in self.records)


@dataclass(frozen=True, eq=False)
class DesignedSecond:
    """The design of the second experiment, how the solver got there, and what other ways would cost."""

    design: Design
    history: tuple[tuple[int, float], ...]
    alternatives: tuple[tuple[str, float], ...]


@dataclass(frozen=True, eq=False)
class Story:
    """Everything that happened."""

    seed: int
    first: Campaign
    initial: LpvEstimate
    designed: DesignedSecond
    signals: tuple[RealisedSignal, ...]
    second: Campaign
    final: LpvEstimate

    @property
    def accuracy(self) -> Accuracy:
        """Standard deviations of θ, asked, expected and reached, and the errors that were made."""
        expected = np.sqrt(np.diag(self.designed.design.expected_covariance))
        reached = np.sqrt(np.diag(self.final.model.covariance))
        error = self.final.model.theta - task.true_model().theta
        return Accuracy(task.PARAMETERS, task.ASKED, expected, reached, error)

    @property
    def worst_share(self) -> float:
        """The largest σ reached over that asked for, over all directions of the parameter space: √λ_max(R P_θ)."""
        covariance = self.final.model.covariance / np.outer(task.ASKED, task.ASKED)
        return float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))

    @property
    def responses(self) -> tuple[FrequencyResponse, ...]:
        """Frequency responses measured in the second experiment."""
        return tuple(PeriodicAverage(drop_periods=1).estimate(record) for record in self.second.records)

    @property
    def prediction_errors(self) -> tuple[FloatArray, ...]:
        """Of the final model, on the records of the second experiment."""
        zeta = self.final.model.coefficients(self.second.points)
        pairs = zip(zeta, self.second.records, strict=True)
        return tuple(prediction_errors(task.STRUCTURE, own, record)[0] for own, record in pairs)


def first_experiment(plant: AirHeater, generator: np.random.Generator, heard: Heard) -> Campaign:
    """A random binary signal, white and of the same power everywhere."""
    inputs = [task.FIRST_POWER * generator.choice([-1.0, 1.0], task.SAMPLES) for _ in task.FIRST_POINTS]
    return _campaign(plant, [(velocity,) for velocity in task.FIRST_POINTS], inputs, None, generator, heard)


def first_model(first: Campaign) -> LpvEstimate:
    """θ̂₁ and its covariance from the local models."""
    found = GeneralisedLeastSquares().estimate(task.STRUCTURE, task.DEPENDENCE, first.records, first.local)
    _require(found.outcome)
    return found


def second_design(first: Campaign, initial: LpvEstimate, heard: Heard) -> DesignedSecond:
    """The least energy that adds what the first experiment has not told [Ghosh2018, Section 4]."""
    history: list[tuple[int, float]] = []

    def progress(iteration: int, gap: float) -> None:
        history.append((iteration, gap))
        heard(f"iteration {iteration}: gap {gap:.1e}")

    designed = design(second_problem(initial, FirSpectra(task.FIR_DEGREE)), progress)
    _require(designed.outcome)
    alternatives = (
        (f"designed, FIR spectra of degree {task.FIR_DEGREE}", designed.total_energy),
        ("designed, line spectra", design(second_problem(initial, LineSpectra(task.SAMPLES))).total_energy),
        ("white noise at the best points", design(second_problem(initial, FirSpectra(0))).total_energy),
        ("more of the first experiment", energy_of_more(first, initial)),
    )
    return DesignedSecond(designed, tuple(history), alternatives)


def second_problem(initial: LpvEstimate, family: SpectrumFamily) -> DesignProblem:
    """The accuracy asked for, with what the first experiment has told as prior information."""
    wanted = tuple(float(sigma) for sigma in (1 - task.MARGIN) * task.ASKED)
    return DesignProblem(
        initial.model,
        task.GRID,
        (ParameterDeviation(wanted),),
        family,
        task.SAMPLES,
        prior_information=np.asarray(np.linalg.inv(initial.model.covariance)),
        tolerance=task.TOLERANCE,
    )


def energy_of_more(first: Campaign, initial: LpvEstimate) -> float:
    """Energy of repeating the first experiment until it alone has reached the accuracy asked for.

    s times the experiment give s P_θ₁⁻¹ ⪰ R, so s is the largest eigenvalue of R P_θ₁.
    """
    sigma = (1 - task.MARGIN) * task.ASKED
    times = np.linalg.eigvalsh(initial.model.covariance / np.outer(sigma, sigma))[-1]
    return float(max(times - 1, 0.0) * first.energy)


def signals_to_play(designed: Design, generator: np.random.Generator, heard: Heard) -> tuple[RealisedSignal, ...]:
    """A multisine for each experiment, several periods of it, within the amplitude limit."""
    played = []
    for experiment in designed.experiments:
        heard(task.AXES.point(experiment.operating_point))
        played.append(
            realise(
                experiment,
                task.PERIOD,
                task.SAMPLE_TIME,
                generator=generator,
                periods=designed.samples // task.PERIOD,
                amplitude_limit=task.AMPLITUDE_LIMIT,
            )
        )
    return tuple(played)


def second_experiment(
    plant: AirHeater,
    designed: Design,
    signals: Sequence[RealisedSignal],
    generator: np.random.Generator,
    heard: Heard,
) -> Campaign:
    """The signals played at their operating points."""
    points = [experiment.operating_point for experiment in designed.experiments]
    return _campaign(plant, points, [signal.record() for signal in signals], task.PERIOD, generator, heard)


def final_model(first: Campaign, second: Campaign) -> LpvEstimate:
    """θ̂ from both experiments at once."""
    estimator = JointLikelihood(initial_conditions="zero")
    records, local = (*first.records, *second.records), (*first.local, *second.local)
    found = estimator.estimate(task.STRUCTURE, task.DEPENDENCE, records, local)
    _require(found.outcome)
    return found


def _campaign(
    plant: AirHeater,
    points: Sequence[OperatingPoint],
    inputs: Sequence[FloatArray],
    period: int | None,
    generator: np.random.Generator,
    heard: Heard,
) -> Campaign:
    records, local = [], []
    for point, power in zip(points, inputs, strict=True):
        heard(task.AXES.point(point))
        temperature = plant.measure(point[0], power, generator)
        records.append(TimeRecord(power, temperature, task.SAMPLE_TIME, point, period))
        local.append(PredictionError(initial_conditions="zero").estimate(task.STRUCTURE, records[-1]))
    return Campaign(tuple(records), tuple(local))


def _require(outcome: Outcome) -> None:
    if not outcome.ok:
        raise MisuseError(f"the demonstration cannot go on: {outcome.advice}; try another seed", "seed")
