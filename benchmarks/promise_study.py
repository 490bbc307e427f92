"""Whether promised designs keep their promise at the true parameters: python -m benchmarks.promise_study --runs 500.

The example of [Ghosh2018, Section 5]: each run draws the estimate of the first experiment (p = 0, 3, 5.5, 8, white
noise) around the truth and designs the second one, for the estimate alone and with a promise; at the true parameters
it is then seen whether P⁻¹ ⪰ R. --family lines takes line spectra in place of FIR spectra of degree 10.
"""

from dataclasses import asdict, dataclass
from functools import partial

import numpy as np
from scipy.linalg import block_diag

from benchmarks.command import command_line, write_json
from benchmarks.ghosh_example import DEPENDENCE, DEVIATIONS, GRID, NOISE_VARIANCE, STRUCTURE, THETA
from benchmarks.processes import spread
from benchmarks.two_stage_study import DEGREE, FIRST_POINTS, FIRST_POWER, SAMPLES
from identification.models.model import Model
from oed.design import design
from oed.information import noise_information, sensitivity_moments
from oed.problem import DesignProblem
from oed.robust import Promise, meets, promised
from oed.spectra.fir import FirSpectra
from oed.spectra.lines import LineSpectra
from oed.targets.parameter_deviation import ParameterDeviation

TRUTH = Model(STRUCTURE, DEPENDENCE, THETA, np.zeros((6, 6)), NOISE_VARIANCE)
FAMILIES = {"fir": FirSpectra(DEGREE), "lines": LineSpectra(SAMPLES)}


@dataclass(frozen=True)
class Run:
    """Whether the design for the estimate alone and the promised one hold at the truth, and what the promise costs."""

    alone: bool
    promised: bool
    ratio: float
    checked: float
    scenario_gap: float


def run(family: str, probability: float, seed: np.random.SeedSequence) -> Run:
    """One estimate, two designs."""
    generator = np.random.default_rng(seed)
    points = np.array(FIRST_POINTS)[:, None]
    told = SAMPLES * FIRST_POWER * sensitivity_moments(TRUTH, points, 0, 1.0)[:, 0].sum(axis=0)
    known = np.asarray(block_diag(told, SAMPLES * noise_information(TRUTH, points).sum(axis=0)))
    covariance = np.linalg.inv(known)
    theta = THETA + np.linalg.cholesky(covariance) @ generator.standard_normal(len(THETA))
    first = Model(STRUCTURE, DEPENDENCE, theta, covariance, NOISE_VARIANCE)
    target = ParameterDeviation(DEVIATIONS)
    problem = DesignProblem(first, GRID, (target,), FAMILIES[family], SAMPLES, prior_information=known)
    alone = design(problem)
    found, kept = promised(problem, Promise(probability, seed=int(generator.integers(2**31))))
    if kept is None:
        raise RuntimeError(found.outcome.advice)
    ratio = found.total_energy / alone.total_energy
    share = kept.kept / kept.checked
    return Run(meets(problem, alone, TRUTH), meets(problem, found, TRUTH), ratio, share, kept.scenario_gap)


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__, runs=500, seed=2018)
    parser.add_argument("--family", choices=sorted(FAMILIES), default="fir")
    parser.add_argument("--probability", type=float, default=0.95)
    options = parser.parse_args()
    runs = spread(partial(run, options.family, options.probability), options.runs, options.seed, options.workers)
    print(f"{options.family}: {len(runs)} runs, promised {options.probability:g}")
    print(f"P⁻¹ ⪰ R at the truth: promised {sum(one.promised for one in runs)}, alone {sum(one.alone for one in runs)}")
    print(f"median energy over that for the estimate alone: {np.median([one.ratio for one in runs]):.3f}")
    print(f"kept in fresh draws: {np.mean([one.checked for one in runs]):.4f} on average")
    print(f"largest gap of the problem over scenarios: {max(one.scenario_gap for one in runs):.1e}")
    write_json([asdict(one) for one in runs], options.output)


if __name__ == "__main__":
    main()
