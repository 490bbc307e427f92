"""The simulation study of Cox, Tóth and Petreczky, Section 5, on random systems: quality and time at five noise levels.

python -m benchmarks.cox_study --runs 100 --workers 2 [--levels inf 40 25 10 0] [--output FILE]

Every run draws its own system (n_x = 4, n_ψ = 5, n_y = n_u = 2, a common quadratic Lyapunov function on [−1, 1]^5),
5000 samples to identify with and 200 noise-free samples to validate with. Compared are, by correlation: the
basis-reduced realisation (n_o = n_r = 10) and the full Hankel matrix ℋ_22, as published and with corrections by the
output error, and the likelihood refinement. The bases are chosen before the clock starts, as in the paper. Times are
the best processor time of three, from the record to the matrices: basis-reduced; ℋ_22 with the shift taken within it;
and Theorem 4 with all rows and columns of ℋ_22, which needs the six shifted matrices too.
"""

import argparse
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.processes import spread
from identification.affine_state_space import Matrices, best_fit_rate, simulate_matrices, variance_accounted_for
from identification.correlation_analysis import CorrelatedSubMarkov, WhiteExcitation
from identification.ho_kalman import Realisation, full_realisation, largest_entries, reduced_realisation
from identification.scheduling import with_constant
from identification.sub_markov import BasisSelection, every_word
from identification.varying.correlation_realisation import CorrelationRealisation
from identification.varying.records import VaryingRecord
from tests.support.random_state_space import random_affine, slow_record, white_record

ORDER, SAMPLES, BASES = 4, 5000, 10
LEVELS = (np.inf, 40.0, 25.0, 10.0, 0.0)
PAPER = {
    "reduced": dict(
        zip(LEVELS, ((83.40, 97.62), (82.55, 97.31), (83.26, 97.56), (82.17, 97.26), (77.20, 95.47)), strict=True)
    ),
    "full": dict(
        zip(LEVELS, ((83.02, 97.43), (82.38, 97.24), (83.46, 97.65), (81.67, 97.09), (76.46, 95.21)), strict=True)
    ),
}


@dataclass(frozen=True)
class Run:
    """One run at one level: (BFR, VAF) in % by method, and the seconds of the three realisations."""

    level: float
    quality: dict[str, tuple[float, float]]
    seconds: dict[str, float]


def run_levels(seed: np.random.SeedSequence, levels: tuple[float, ...], refine: bool) -> list[Run]:
    """One system at every level, with the same input, scheduling and noise sequence."""
    system, validation, measurement = (np.random.default_rng(each) for each in seed.spawn(3))
    model, _ = random_affine(system)
    held_out = slow_record(model, validation)
    state = measurement.bit_generator.state
    runs = []
    for level in levels:
        measurement.bit_generator.state = state
        runs.append(_run(white_record(model, measurement, SAMPLES, level), held_out, level, refine))
    return runs


def _run(record: VaryingRecord, held_out: VaryingRecord, level: float, refine: bool) -> Run:
    every = every_word(2, record.scheduling.shape[1] + 1, 2)
    rows, columns = largest_entries(_correlated(record).hankel(every, every), BASES, BASES)
    selected = every.subset(rows), every.subset(columns)
    published: dict[str, tuple[float, Realisation]] = {
        "reduced": _timed(partial(_reduced, record, selected)),
        "full": _timed(lambda: full_realisation(_correlated(record), (2, 2), ORDER)),
        "full, Theorem 4": _timed(partial(_reduced, record, (every, every))),
    }
    quality = {name: _quality(found.matrices, held_out) for name, (_, found) in published.items()}
    whole = CorrelationRealisation(parameters="correlation", hankel="full", refinement=False)
    quality["full, corrected"] = _estimated(whole, record, held_out)
    quality["reduced, corrected"] = _estimated(replace(whole, hankel="reduced"), record, held_out)
    if refine:
        quality["refined"] = _estimated(replace(whole, hankel="reduced", refinement=True), record, held_out)
    return Run(level, quality, {name: seconds for name, (seconds, _) in published.items()})


def _correlated(record: VaryingRecord) -> CorrelatedSubMarkov:
    return WhiteExcitation(with_constant(record.scheduling), record.input).fit(record.output)


def _reduced(record: VaryingRecord, selected: tuple[BasisSelection, BasisSelection]) -> Realisation:
    return reduced_realisation(_correlated(record), *selected, ORDER)


def _timed(realise: Callable[[], Realisation]) -> tuple[float, Realisation]:
    best = np.inf
    for _ in range(3):
        start = process_time()
        found = realise()
        best = min(best, process_time() - start)
    return float(best), found


def _quality(matrices: Matrices, held_out: VaryingRecord) -> tuple[float, float]:
    simulated = simulate_matrices(matrices, held_out.input, held_out.scheduling)
    if not np.all(np.isfinite(simulated)):
        return 0.0, 0.0
    return best_fit_rate(held_out.output, simulated), variance_accounted_for(held_out.output, simulated)


def _estimated(method: CorrelationRealisation, record: VaryingRecord, held_out: VaryingRecord) -> tuple[float, float]:
    model = method.estimate(record, ORDER).model
    return _quality((model.a, model.b, model.c, model.d), held_out)


def summary(runs: list[Run]) -> list[dict[str, float | str | None]]:
    """One row for each level and method: mean and standard deviation of BFR and VAF, the paper's means, and seconds."""
    rows: list[dict[str, float | str | None]] = []
    for level in dict.fromkeys(run.level for run in runs):
        of_level = [run for run in runs if run.level == level]
        for method in of_level[0].quality:
            quality = np.array([run.quality[method] for run in of_level])
            seconds = [run.seconds[method] for run in of_level if method in run.seconds]
            paper = PAPER.get(method, {}).get(level, (None, None))
            rows.append(
                {
                    "level dB": str(level),
                    "method": method,
                    **{f"{name} mean": float(quality[:, i].mean()) for i, name in enumerate(("BFR", "VAF"))},
                    **{f"{name} std": float(quality[:, i].std(ddof=1)) for i, name in enumerate(("BFR", "VAF"))},
                    "VAF least": float(quality[:, 1].min()),
                    "paper BFR": paper[0],
                    "paper VAF": paper[1],
                    "median ms": 1e3 * float(np.median(seconds)) if seconds else None,
                }
            )
    return rows


def ratios(runs: list[Run]) -> dict[str, float]:
    """How many times longer the full realisations take than the basis-reduced one, median over the runs."""
    return {
        name: float(np.median([run.seconds[name] / run.seconds["reduced"] for run in runs]))
        for name in ("full", "full, Theorem 4")
    }


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=2018)
    parser.add_argument("--levels", type=float, nargs="+", default=list(LEVELS))
    parser.add_argument("--no-refinement", action="store_true")
    parser.add_argument("--output", type=Path, default=None)
    options = parser.parse_args()
    work = partial(run_levels, levels=tuple(options.levels), refine=not options.no_refinement)
    runs = [run for each in spread(work, options.runs, options.seed, options.workers) for run in each]
    rows = summary(runs)
    print(" ".join(f"{name:>18s}" for name in rows[0]))
    for row in rows:
        print(
            " ".join(f"{value:18.4f}" if isinstance(value, float) else f"{value or '':>18s}" for value in row.values())
        )
    times = ratios(runs)
    print({name: round(value, 2) for name, value in times.items()}, "times the basis-reduced realisation's time")
    if options.output is not None:
        every = [{**asdict(run), "level": str(run.level)} for run in runs]
        options.output.write_text(json.dumps({"table": rows, "time ratios": times, "runs": every}, indent=1) + "\n")


if __name__ == "__main__":
    main()
