"""Processor seconds and memory of a design over parameters, points, lines and targets: three scheduling variables.

python -m benchmarks.design_scale [--parameters 24 40 60] [--points 1728] [--lines 256] [--targets 1] [--output FILE]

The plant is a random resonance of which every coefficient is a polynomial in three scheduling variables; each case runs
in a process of its own, whose peak memory is that of the case.
"""

import multiprocessing
import resource
import time
from itertools import product

import numpy as np

from benchmarks.command import command_line, write_json
from identification.bases.polynomial import Polynomial
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from oed.design import design
from oed.problem import DesignProblem, Target
from oed.spectra.lines import LineSpectra
from oed.targets.parameter_deviation import ParameterDeviation
from oed.targets.response_deviation import ResponseDeviation

SHAPES = {16: ((1, 1, 0), 4), 24: ((1, 1, 1), 3), 40: ((1, 1, 1), 5), 60: ((2, 1, 1), 5), 80: ((3, 1, 1), 5)}
VARIABLES = tuple(SchedulingVariable(name, "1", -1.0, 1.0) for name in ("p", "q", "r"))


def main() -> None:
    """Print a row per case, and write the figures as JSON."""
    parser = command_line(__doc__, runs=1)
    parser.add_argument("--parameters", type=int, nargs="+", default=[24, 40], choices=sorted(SHAPES))
    parser.add_argument("--points", type=int, nargs="+", default=[1728])
    parser.add_argument("--lines", type=int, nargs="+", default=[256])
    parser.add_argument("--targets", type=int, nargs="+", default=[1])
    asked = parser.parse_args()
    rows = []
    print("    k  points  lines  targets   seconds   peak MB      energy      gap  iterations")
    for case in product(asked.parameters, asked.points, asked.lines, asked.targets):
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            row = pool.apply(measured, case)
        rows.append(row)
        print(
            f"{row['parameters']:5.0f} {row['points']:7.0f} {row['lines']:6.0f} {row['targets']:8.0f}"
            f" {row['seconds']:9.2f} {row['megabytes']:9.0f} {row['energy']:11.5g} {row['gap']:8.1e}"
            f" {row['iterations']:11.0f}",
            flush=True,
        )
    write_json(rows, asked.output)


def measured(parameters: int, points: int, lines: int, targets: int) -> dict[str, float]:
    """One design: processor seconds, peak memory of the process, energy and gap."""
    problem = stated(parameters, points, lines, targets)
    start = time.process_time()
    found = design(problem)
    seconds = time.process_time() - start
    if not found.outcome.ok:
        raise RuntimeError(found.outcome.advice)
    return {
        "parameters": parameters,
        "points": len(problem.points),
        "lines": lines,
        "targets": targets,
        "seconds": seconds,
        "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "energy": found.total_energy,
        "gap": found.gap,
        "iterations": found.outcome.iterations,
    }


def stated(parameters: int, points: int, lines: int, targets: int) -> DesignProblem:
    """Standard deviations of all parameters, or of the response at random places."""
    degrees, coefficients = SHAPES[parameters]
    structure = RationalStructure(n_a=2, n_b=coefficients - 3, n_k=1, n_c=0, n_d=0, sample_time=1.0)
    basis = ProductBasis(tuple(Polynomial(degree) for degree in degrees))
    dependence = ParameterDependence(VARIABLES, (basis,) * structure.size)
    rng = np.random.default_rng(parameters)
    theta = 0.02 * rng.normal(size=(structure.size, basis.size))
    theta[:, 0] = [-1.2, 0.6, *([1.0] + [0.3] * (coefficients - 3))]
    model = Model(structure, dependence, theta.ravel(), np.zeros((theta.size,) * 2), 1.0)
    side = np.linspace(-1, 1, round(points ** (1 / 3)))
    grid = np.array(list(product(side, side, side)))
    return DesignProblem(model, grid, _targets(theta.size, targets, rng), LineSpectra(2 * lines), 4 * lines)


def _targets(k: int, count: int, rng: np.random.Generator) -> tuple[Target, ...]:
    if count == 1:
        return (ParameterDeviation((0.01,) * k),)
    places = tuple(tuple(map(float, row)) for row in rng.uniform(-1, 1, (max(1, count // 20), 3)))
    return (ResponseDeviation(places, 0.05, 3.0, 0.01, True, min(count, 20)),)


if __name__ == "__main__":
    main()
