"""Is the stated covariance true? python -m benchmarks.covariance_truth --runs 1000.

For every estimator a small system is measured many times; (x̂ − x)ᵀ P̂⁻¹ (x̂ − x) is held against χ² at 5 %, and the
number of rejections must lie in its own 99 % binomial interval. Prints a table; --output writes JSON.
"""

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from scipy import stats

from benchmarks.command import command_line, write_json
from benchmarks.ghosh_example import DEPENDENCE, STRUCTURE, THETA, measured
from benchmarks.processes import spread
from identification.arrays import FloatArray
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.lti.rational_fit import RationalFit
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate

LEVEL = 0.05
SAMPLES = 1000
POINTS = (0.0, 3.0, 5.5, 8.0)
BOX_JENKINS = RationalStructure(n_a=2, n_b=1, n_k=1, n_c=1, n_d=1, sample_time=1.0)
ZETA = np.array([-1.5, 0.7, 1.0, 0.5, 0.4, -0.8])
RESPONSE = RationalStructure(n_a=2, n_b=1)
ZETA_OF_RESPONSE = np.array([0.4, 1.0, 0.5, 2.0])


def distance(estimate: FloatArray, truth: FloatArray, covariance: FloatArray) -> float:
    """(x̂ − x)ᵀ P⁻¹ (x̂ − x)."""
    return float((estimate - truth) @ np.linalg.solve(covariance, estimate - truth))


def prediction_error(generator: np.random.Generator, initial: str = "zero") -> float:
    """A Box–Jenkins model of second order from white input, from rest or from an unknown state."""
    settling = 0 if initial == "zero" else 200
    u, e = generator.standard_normal((2, SAMPLES + settling))
    y = simulate(BOX_JENKINS, ZETA, u, e)
    record = TimeRecord(u[settling:], y[settling:], 1.0, (0.0,))
    model = PredictionError(initial).estimate(BOX_JENKINS, record).model  # type: ignore[arg-type]
    return distance(model.zeta, ZETA, model.covariance)


def settled_prediction_error(generator: np.random.Generator) -> float:
    """The same from a record cut out of a longer one."""
    return prediction_error(generator, "estimate")


def rational_fit(generator: np.random.Generator) -> float:
    """A continuous-time model of second order from a frequency response of known variance."""
    data = _response(generator, RESPONSE, ZETA_OF_RESPONSE, np.linspace(0.05, 4.0, 60), 0.05, (0.0,))
    model = RationalFit().estimate(RESPONSE, data).model
    return distance(model.zeta, ZETA_OF_RESPONSE, model.covariance)


def two_step(generator: np.random.Generator) -> float:
    """Local prediction error estimates of the example, then generalised least squares."""
    records = _records(generator)
    local = [PredictionError("zero").estimate(STRUCTURE, record) for record in records]
    model = GeneralisedLeastSquares().estimate(STRUCTURE, DEPENDENCE, records, local).model
    return distance(model.theta, THETA, model.covariance)


def joint(generator: np.random.Generator) -> float:
    """Joint likelihood of the example's records."""
    model = JointLikelihood("zero").estimate(STRUCTURE, DEPENDENCE, _records(generator)).model
    return distance(model.theta, THETA, model.covariance)


def joint_of_lines(generator: np.random.Generator) -> float:
    """Joint likelihood of steady records of few lines, a constant input among them, and of a frequency response."""
    lines = {0.0: (16,), 1.5: (0,), 8.0: (180, 218)}
    records = [_steady(point, lines[point], generator) for point in lines]
    zeta = (DEPENDENCE.matrix([[4.0]]) @ THETA)[0]
    response = _response(generator, STRUCTURE, zeta, np.linspace(0.1, 2.0, 5), 0.3, (4.0,))
    model = JointLikelihood("estimate").estimate(STRUCTURE, DEPENDENCE, [*records, response]).model
    return distance(model.theta, THETA, model.covariance)


CASES: dict[str, tuple[Callable[[np.random.Generator], float], int]] = {
    "prediction error, from rest": (prediction_error, len(ZETA)),
    "prediction error, unknown state": (settled_prediction_error, len(ZETA)),
    "rational fit": (rational_fit, len(ZETA_OF_RESPONSE)),
    "generalised least squares": (two_step, len(THETA)),
    "joint likelihood": (joint, len(THETA)),
    "joint likelihood, lines and response": (joint_of_lines, len(THETA)),
}


def _records(generator: np.random.Generator) -> list[TimeRecord]:
    return [measured((p,), generator.standard_normal(SAMPLES) * np.sqrt(0.75), generator) for p in POINTS]


def _steady(point: float, indices: tuple[int, ...], generator: np.random.Generator) -> TimeRecord:
    zeta = (DEPENDENCE.matrix([[point]]) @ THETA)[0]
    phases = 2 * np.pi * np.outer(indices, np.arange(SAMPLES)) / SAMPLES
    u = np.cos(phases + np.arange(len(indices))[:, None]).sum(axis=0)
    noise = simulate(STRUCTURE, np.array([0.0, 0.0, zeta[2]]), u, generator.standard_normal(SAMPLES) * np.sqrt(0.5))
    return TimeRecord(u, simulate(STRUCTURE, zeta, u, periodic=True) + noise, 1.0, (point,))


def _response(
    generator: np.random.Generator,
    structure: RationalStructure,
    zeta: FloatArray,
    omega: FloatArray,
    deviation: float,
    point: tuple[float, ...],
) -> FrequencyResponse:
    noise = deviation * (generator.standard_normal((2, len(omega))).T @ np.array([1, 1j])) / np.sqrt(2)
    response = structure.plant_response(zeta, omega) + noise
    return FrequencyResponse(omega, response, point, structure.sample_time, np.full(len(omega), deviation**2))


def all_distances(seed: np.random.SeedSequence) -> dict[str, float]:
    """One run of every case."""
    seeds = seed.spawn(len(CASES))
    return {name: run(np.random.default_rng(s)) for s, (name, (run, _)) in zip(seeds, CASES.items(), strict=True)}


def verdict(distances: FloatArray, dimension: int) -> dict[str, Any]:
    """Rejections at 5 % against their 99 % interval, and the mean of the distances against the dimension."""
    runs = len(distances)
    rejected = int(np.sum(distances > stats.chi2.isf(LEVEL, dimension)))
    low, high = stats.binom.interval(0.99, runs, LEVEL)
    return {
        "runs": runs,
        "rejected": rejected,
        "interval": [int(low), int(high)],
        "true": bool(low <= rejected <= high),
        "mean over dimension": float(np.mean(distances) / dimension),
    }


def main() -> None:
    """Parses the command line, runs, prints."""
    options = command_line(__doc__, runs=1000, seed=2018).parse_args()
    start = perf_counter()
    found = spread(all_distances, options.runs, options.seed, options.workers)
    result: dict[str, Any] = {
        name: verdict(np.array([each[name] for each in found]), dimension) for name, (_, dimension) in CASES.items()
    }
    for name, each in result.items():
        low, high = each["interval"]
        print(f"{name:38s} {each['rejected']:4d} of {each['runs']} in [{low}, {high}] {each['true']!s:5s}", end=" ")
        print(f"mean {each['mean over dimension']:.3f}")
    write_json({"cases": result, "seconds": perf_counter() - start}, options.output)


if __name__ == "__main__":
    main()
