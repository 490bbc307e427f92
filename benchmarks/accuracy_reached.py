"""Designs played on the plant and identified, many times: is the accuracy reached that was asked for?

    python -m benchmarks.accuracy_reached [--runs 200] [--workers 2] [--seed 1] [--output FILE]

The example of [Ghosh2018, Section 5] is designed from the true θ, realised as multisines and as filtered noise, played
with the noise of the paper, and identified. Two questions, for θ_G and θ_H together:

- does the covariance that each run states keep P_θ⁻¹ ⪰ R within its sampling error? The smallest eigenvalue of
  R^{−1/2} P_θ⁻¹ R^{−1/2} must exceed 1 − 2 s, with s its own standard deviation over the runs;
- do the errors keep (θ̂ − θ⁰)ᵀ R (θ̂ − θ⁰) < 12.6, the 95 % quantile of χ²(6)?

Both in 19 of 20 runs or more. And the covariance of θ̂ over the runs: the largest eigenvalue of R^{1/2} C R^{1/2} stays
below (1 + √(6/runs))², the edge of its sampling error if C = R⁻¹.
"""

from functools import partial
from time import perf_counter

import numpy as np

from benchmarks.command import command_line, shown, write_json
from benchmarks.ghosh_example import ACCEPTED, DEPENDENCE, DEVIATIONS, GRID, NOISE_VARIANCE, STRUCTURE, THETA, measured
from benchmarks.processes import spread
from identification.arrays import FloatArray
from identification.lpv.joint_likelihood import JointLikelihood
from identification.models.model import Model
from oed.design import Design, design
from oed.problem import DesignProblem
from oed.realisation import realise
from oed.spectra.family import SpectrumFamily
from oed.spectra.fir import FirSpectra
from oed.spectra.lines import LineSpectra
from oed.targets.parameter_deviation import ParameterDeviation

SAMPLES = 1000
CASES: dict[str, tuple[SpectrumFamily, str]] = {
    "FIR spectra as multisines": (FirSpectra(10), "multisine"),
    "FIR spectra as filtered noise": (FirSpectra(10), "filtered_noise"),
    "line spectra as multisines": (LineSpectra(SAMPLES), "multisine"),
}


def designed(family: SpectrumFamily) -> Design:
    """The design from the true parameters."""
    model = Model(STRUCTURE, DEPENDENCE, THETA, np.zeros((6, 6)), NOISE_VARIANCE)
    return design(DesignProblem(model, GRID, (ParameterDeviation(DEVIATIONS),), family, SAMPLES))


def played(case: str, seed: np.random.SeedSequence) -> FloatArray:
    """The smallest eigenvalue of R^{−1/2} P⁻¹ R^{−1/2}, and R^{1/2} (θ̂ − θ⁰), of one run."""
    generator = np.random.default_rng(seed)
    family, method = CASES[case]
    plan = designed(family)
    records = []
    for experiment in plan.experiments:
        signal = realise(experiment, plan.samples, 1.0, generator=generator, method=method)
        records.append(measured(experiment.operating_point, signal.record(), generator))
    model = JointLikelihood("zero").estimate(STRUCTURE, DEPENDENCE, records).model
    scale = np.array(DEVIATIONS)
    information = np.linalg.inv(model.covariance / np.outer(scale, scale))
    return np.concatenate([np.linalg.eigvalsh(information)[:1], (model.theta - THETA) / scale])


def study(case: str, runs: int, seed: int, workers: int) -> dict[str, object]:
    """All runs of one case."""
    start = perf_counter()
    outcomes = np.array(spread(partial(played, case), runs, seed, workers))
    eigenvalues, errors = outcomes[:, 0], outcomes[:, 1:]
    spread_of_eigenvalues = float(eigenvalues.std(ddof=1))
    kept = int(np.sum(eigenvalues >= 1 - 2 * spread_of_eigenvalues))
    return {
        "case": case,
        "runs": runs,
        "P⁻¹ ⪰ R within sampling error": kept,
        "smallest eigenvalue, mean": float(eigenvalues.mean()),
        "smallest eigenvalue, standard deviation": spread_of_eigenvalues,
        "errors accepted": int(np.sum(np.sum(errors**2, axis=1) < ACCEPTED)),
        "covariance over the runs, largest eigenvalue": float(np.linalg.eigvalsh(np.cov(errors.T))[-1]),
        "its edge": (1 + (errors.shape[1] / runs) ** 0.5) ** 2,
        "seconds": perf_counter() - start,
    }


def main() -> None:
    """Parses the command line, runs, prints."""
    options = command_line(__doc__, runs=200, seed=1).parse_args()
    results = [study(case, options.runs, options.seed, options.workers) for case in CASES]
    for result in results:
        print("; ".join(f"{name}: {shown(value)}" for name, value in result.items()))
    write_json(results, options.output)


if __name__ == "__main__":
    main()
