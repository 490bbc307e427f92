"""The two-stage procedure of [Ghosh2018, Sections 4 and 5] many times: python -m benchmarks.two_stage_study --runs 500.

An initial experiment at p = 0, 3, 5.5, 8 with white noise gives a first model; the second experiment is designed from
it with what is still missing in accuracy, played as filtered noise, identified, and combined with the first. Prints a
table against the figures of the paper; --output writes JSON.
"""

from dataclasses import asdict, dataclass
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.command import command_line, write_json
from benchmarks.ghosh_example import ACCEPTED, DEPENDENCE, DEVIATIONS, GRID, STRUCTURE, THETA, measured
from benchmarks.processes import spread
from identification.estimates import Estimate
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.models.model import Model
from identification.signals import TimeRecord
from oed.design import Design, design
from oed.problem import DesignProblem
from oed.realisation.filtered_noise import filtered_noise
from oed.spectra.fir import FirSpectra
from oed.targets.parameter_deviation import ParameterDeviation

SAMPLES = 1000
FIRST_POINTS = (0.0, 3.0, 5.5, 8.0)
FIRST_POWER = 0.75
DEGREE = 10
PAPER = {"mean energy": 1741, "largest energy": 2319, "accepted of 500": 499}


@dataclass(frozen=True)
class Run:
    """What one run gave: the designed energy and points, and (θ̂ − θ⁰)ᵀR(θ̂ − θ⁰) for both ways to combine."""

    status: str
    energy: float
    gap: float
    points: tuple[float, ...]
    two_step: float
    joint: float
    two_step_own: float
    joint_own: float
    seconds_of_design: float


def two_stages(seed: np.random.SeedSequence) -> Run:
    """One run of both stages."""
    generator = np.random.default_rng(seed)
    white = [generator.standard_normal(SAMPLES) * np.sqrt(FIRST_POWER) for _ in FIRST_POINTS]
    first = _two_step([measured((p,), u, generator) for p, u in zip(FIRST_POINTS, white, strict=True)], None).model
    start = perf_counter()
    found = design(_problem(first))
    seconds = perf_counter() - start
    records = [
        measured(each.operating_point, filtered_noise(each.spectrum.coefficients, found.samples, generator), generator)
        for each in found.experiments
    ]
    return _described(found, _two_step(records, first), _joint(records, first), seconds)


def _problem(first: Model) -> DesignProblem:
    return DesignProblem(
        model=first,
        points=GRID,
        targets=(ParameterDeviation(DEVIATIONS),),
        family=FirSpectra(DEGREE),
        samples=SAMPLES,
        prior_information=np.linalg.inv(first.covariance),
    )


def _two_step(records: list[TimeRecord], prior: Model | None) -> Estimate:
    estimator = PredictionError("zero")
    local = [estimator.estimate(STRUCTURE, record) for record in records]
    return GeneralisedLeastSquares().estimate(STRUCTURE, DEPENDENCE, records, local, prior)


def _joint(records: list[TimeRecord], prior: Model) -> Estimate:
    return JointLikelihood("zero").estimate(STRUCTURE, DEPENDENCE, records, prior=prior)


def _described(found: Design, two_step: Estimate, joint: Estimate, seconds: float) -> Run:
    errors = [each.model.theta - THETA for each in (two_step, joint)]
    asked = [float(np.sum((error / DEVIATIONS) ** 2)) for error in errors]
    covariances = [each.model.covariance for each in (two_step, joint)]
    own = [float(error @ np.linalg.solve(P, error)) for error, P in zip(errors, covariances, strict=True)]
    return Run(
        found.outcome.status,
        found.total_energy,
        found.gap,
        tuple(each.operating_point[0] for each in found.experiments),
        *asked,
        *own,
        seconds,
    )


def summary(runs: list[Run], seconds: float, workers: int) -> dict[str, Any]:
    """The figures that the paper prints, and how the rest went."""
    energies = np.array([run.energy for run in runs])
    return {
        "runs": len(runs),
        "designs converged": sum(run.status == "converged" for run in runs),
        "mean energy": float(energies.mean()),
        "largest energy": float(energies.max()),
        "smallest energy": float(energies.min()),
        "largest gap": max(run.gap for run in runs),
        "accepted, two-step": sum(run.two_step < ACCEPTED for run in runs),
        "accepted, joint": sum(run.joint < ACCEPTED for run in runs),
        "inside own 95 % ellipsoid, two-step": sum(run.two_step_own < ACCEPTED for run in runs),
        "inside own 95 % ellipsoid, joint": sum(run.joint_own < ACCEPTED for run in runs),
        "mean seconds of a design": float(np.mean([run.seconds_of_design for run in runs])),
        "seconds in all": seconds,
        "workers": workers,
    }


def main() -> None:
    """Parses the command line, runs, prints."""
    options = command_line(__doc__, runs=500, seed=2018).parse_args()
    start = perf_counter()
    runs = spread(two_stages, options.runs, options.seed, options.workers)
    result = summary(runs, perf_counter() - start, options.workers)
    for name, value in result.items():
        shown = f"{value:.4g}" if isinstance(value, float) else str(value)
        print(f"{name:40s} {shown:>10s}   {PAPER.get(name, '')}")
    write_json({"summary": result, "paper": PAPER, "runs": [asdict(run) for run in runs]}, options.output)


if __name__ == "__main__":
    main()
