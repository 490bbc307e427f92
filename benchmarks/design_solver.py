"""Times of the certified solver against the inequality as written, on the example of the paper, in one run.

python -m benchmarks.design_solver [--runs 7] [--degrees 10 20 40] [--output FILE]
"""

import statistics

import numpy as np

from benchmarks.command import command_line, timed, write_json
from benchmarks.ghosh_example import DEPENDENCE, DEVIATIONS, GRID, NOISE_VARIANCE, STRUCTURE, THETA
from identification.models.model import Model
from oed.design import design
from oed.direct_lmi import direct_design
from oed.problem import DesignProblem
from oed.spectra.fir import FirSpectra
from oed.targets.parameter_deviation import ParameterDeviation

MODEL = Model(STRUCTURE, DEPENDENCE, THETA, np.zeros((6, 6)), NOISE_VARIANCE)


def main() -> None:
    """Print a row per degree, and write the figures as JSON."""
    parser = command_line(__doc__, runs=7)
    parser.add_argument("--degrees", type=int, nargs="+", default=[10, 20, 40])
    arguments = parser.parse_args()
    rows = [compare(degree, arguments.runs) for degree in arguments.degrees]
    print("degree  certified J  as written J   gap      certified    as written   ratio (median, min … max)")
    for row in rows:
        print(
            f"{row['degree']:6d} {row['certified']:12.2f} {row['asWritten']:13.2f}   {row['gap']:.0e}"
            f" {1e3 * row['certifiedSeconds']:9.1f} ms {1e3 * row['asWrittenSeconds']:10.0f} ms"
            f"   {row['ratio']:.1f} ({row['ratioMinimum']:.1f} … {row['ratioMaximum']:.1f})"
        )
    write_json(rows, arguments.output)


def compare(degree: int, runs: int) -> dict[str, float]:
    """Both solvers by turns; every time is that of one whole call from the same problem."""
    problem = DesignProblem(MODEL, GRID, (ParameterDeviation(DEVIATIONS),), FirSpectra(degree), 1000)
    certified, direct = design(problem), direct_design(problem)
    pairs = [(timed(lambda: design(problem)), timed(lambda: direct_design(problem))) for _ in range(runs)]
    ratios = [slow / fast for fast, slow in pairs]
    return {
        "degree": degree,
        "certified": certified.total_energy,
        "asWritten": direct.total_energy,
        "gap": certified.gap,
        "certifiedSeconds": statistics.median(fast for fast, _ in pairs),
        "asWrittenSeconds": statistics.median(slow for _, slow in pairs),
        "ratio": statistics.median(ratios),
        "ratioMinimum": min(ratios),
        "ratioMaximum": max(ratios),
    }


if __name__ == "__main__":
    main()
