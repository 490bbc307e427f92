"""A design that would notice: python -m benchmarks.detection_power --runs 300 --output power.json.

Asks for the experiments of least energy that show a cubic stiffness of a stated size with 90 % power in a test at 5 %,
plays them on the virtual bench (Runge–Kutta, its own noise) with that stiffness hidden and with nothing hidden, and
counts how often the score test sees it.
"""

import argparse
import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binom

from benchmarks.processes import over
from benchmarks.virtual_bench.bench import PERIOD, SAMPLE_TIME
from benchmarks.virtual_bench.played import records, steady
from benchmarks.virtual_bench.study import MODEL
from identification.comparison.gather import gather
from identification.diagnosis.scores import score_tests
from identification.diagnosis.signatures import candidates
from identification.effects.cubic_stiffness import CubicStiffness
from identification.extension.fit import fit
from identification.extension.model import ExtendedModel
from identification.extension.rows import Rows
from oed.design import Design, design
from oed.problem import DesignProblem
from oed.spectra.multisines import Multisines
from oed.targets.effect_detection import EffectDetection

SIGMA, SIZE, POWER, LEVEL = 0.01, 0.02, 0.9, 0.05
POINTS = np.linspace(-1, 1, 5)[:, None]
FAMILY = Multisines(PERIOD, levels=(2.0, 4.0, 8.0))
MOST_PERIODS = 64
KNOWN = ExtendedModel(replace(MODEL.base, noise_variance=SIGMA**2))


def problem(size: float = SIZE) -> DesignProblem:
    """The least energy that shows a cubic stiffness of this size."""
    target = EffectDetection("cubic_stiffness", size, power=POWER, level=LEVEL)
    band = (2 * np.pi / (PERIOD * SAMPLE_TIME), 0.9 * np.pi / SAMPLE_TIME)
    samples = MOST_PERIODS * PERIOD
    return DesignProblem(KNOWN, POINTS, (target,), FAMILY, samples, sample_time=SAMPLE_TIME, band=band)


def seen(played: Any, flows: Any, seed: int) -> bool:
    """Whether the score test at 5 % sees the stiffness in one measurement of the experiments."""
    batches = gather(records(played, flows, SIGMA, np.random.default_rng(seed)))
    base = fit(MODEL, Rows(batches))
    found = score_tests(base, candidates(base, (CubicStiffness(),)), np.random.default_rng(seed))
    return bool(found[0].p_value < LEVEL)


def _runs(task: tuple[Any, Any, int, int]) -> list[bool]:
    played, flows, first, last = task
    return [seen(played, flows, seed) for seed in range(first, last)]


def rate(played: Any, size: float, runs: int, workers: int) -> float:
    """The share of runs in which the stiffness is seen, with so much of it hidden."""
    hidden = (("cubic_stiffness", size),) if size else ()
    flows = steady(played, hidden)
    edges = np.linspace(0, runs, 4 * workers + 1).astype(int)
    parts = over(_runs, [(played, flows, int(a), int(b)) for a, b in pairwise(edges)], workers)
    return float(np.mean([one for part in parts for one in part]))


def study(runs: int, workers: int, size: float = SIZE) -> dict[str, Any]:
    """The design with its certificate, and what was measured with it."""
    found = design(problem(size))
    played = [(one.operating_point[0], one.spectrum) for one in found.experiments]
    decision = found.decisions[0][1]
    return {
        "cubic stiffness": size,
        "noise standard deviation": SIGMA,
        "asked power": POWER,
        "level": LEVEL,
        "least energy": found.least_energy,
        "lower bound": found.lower_bound,
        "certified gap": found.gap,
        "energy of whole periods": found.total_energy,
        "experiments": _described(found),
        "expected standard deviation": float(np.sqrt(decision.variance)),
        "expected power": decision.power,
        "99 % interval of 90 %": [float(x) for x in binom.ppf([0.005, 0.995], runs, POWER) / runs],
        "measured power": rate(played, size, runs, workers),
        "measured level": rate(played, 0.0, runs, workers),
        "runs": runs,
    }


def _described(found: Design) -> list[dict[str, Any]]:
    return [
        {
            "operating point": one.operating_point[0],
            "root mean square of the input": one.spectrum.level,
            "band in rad/s": [float(one.spectrum.frequencies[0]), float(one.spectrum.frequencies[-1])],
            "periods": one.spectrum.periods,
        }
        for one in found.experiments
    ]


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--size", type=float, default=SIZE)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--output", type=Path, default=None)
    options = parser.parse_args()
    summary = study(options.runs, options.workers, options.size)
    print(json.dumps(summary, indent=1))
    if options.output is not None:
        options.output.write_text(json.dumps(summary, indent=1) + "\n")


if __name__ == "__main__":
    main()
