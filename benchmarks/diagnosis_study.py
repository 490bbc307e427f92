"""How well the diagnosis does on the virtual bench: python -m benchmarks.diagnosis_study hits --runs 10.

Studies: hits (one effect hidden at a time), alarms (nothing hidden), pairs (two hidden), unknown (an effect taken out
of the library). Prints a table, and with --output writes everything as JSON.
"""

import argparse
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from scipy.stats import kstest

from benchmarks.processes import over
from benchmarks.virtual_bench.bench import Bench, experiments, noisy
from benchmarks.virtual_bench.hidden import HIDDEN
from benchmarks.virtual_bench.study import MODEL, effects, measured, steady, strengths
from identification.comparison.batch import Batch
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import Diagnosis, diagnose
from identification.diagnosis.staircase import conclusion, relative_error, staircase
from identification.extension.fit import fit
from identification.extension.model import ExtendedModel

INVISIBLE = {"time_base"}
TIED_TO_RECORDS = {"misplaced_point", "second_variable", "gain_drift", "hum"}
SHARES = (0.01, 0.03, 0.1)
REMOVED = ("cubic_stiffness", "coulomb_friction", "resonance", "quadratic_sensor", "cubic_dependence")
CONDITIONS: tuple[dict[str, Any], ...] = (
    {"share": 0.01},
    {"share": 0.03},
    {"share": 0.1},
    {"share": 0.3},
    {"share": 0.03, "colour": 0.9},
    {"share": 0.1, "colour": 0.6},
    {"share": 0.03, "heavy": True},
    {"share": 0.03, "spread": 5.0},
    {"share": 0.03, "points": 3},
    {"share": 0.03, "points": 15},
)


def kinds() -> list[str]:
    """The effects that the bench can hide and its experiment can show."""
    return [kind for kind in HIDDEN if kind not in INVISIBLE]


def _design():
    return experiments(np.random.default_rng(2024))


@cache
def held_out(hidden: tuple[str, ...]) -> tuple[Batch, ...]:
    """Other operating points, level and lines, nearly without noise."""
    if set(hidden) & TIED_TO_RECORDS:
        done, y = steady(hidden)
    else:
        done = experiments(np.random.default_rng(7), points=6, levels=(15.0,))
        y = Bench(tuple((kind, strengths()[kind]) for kind in hidden)).steady(done)
    return gather(noisy(y, done, 1e-5, np.random.default_rng(1)))


def truth(kind: str) -> np.ndarray:
    """The amplitudes that the diagnosis should find."""
    e = strengths()[kind]
    return np.array([e * np.cos(0.7), -e * np.sin(0.7)]) if kind == "hum" else np.array([e])


def one_hit(task: tuple[str, float, int]) -> dict[str, Any]:
    """One run with one effect hidden."""
    kind, share, seed = task
    batches = measured((kind,), share, np.random.default_rng(seed))
    start = perf_counter()
    found = diagnose(MODEL, batches, effects(_design()), seed=seed)
    seconds = perf_counter() - start
    names = [one.score.candidate.effect.kind for one in found.announced]
    first = names[0] if names else "nothing"
    by_score = max(found.scores, key=lambda one: one.statistic).candidate.effect.kind
    result: dict[str, Any] = {
        "kind": kind,
        "share": share,
        "first": first,
        "first by score": by_score,
        "in set": kind in names,
        "set size": len(names),
        "confident and wrong": found.confident and first != kind,
        "seconds": seconds,
    }
    if found.best is not None:
        result |= _after(kind, found)
    return result


def _after(kind: str, found: Diagnosis) -> dict[str, Any]:
    assert found.best is not None
    outside = held_out((kind,))
    before = relative_error(found.base.model, outside)
    grown = fit(found.best.fit.model, found.best.fit.rows, exact=True)
    result: dict[str, Any] = {"error before": before, "error after": relative_error(grown.model, outside)}
    right = next((one for one in found.evidence if one.score.candidate.effect.kind == kind), None)
    if right is not None:
        result["error with the truth"] = relative_error(right.fit.model, outside)
    if found.best.score.candidate.effect.kind == kind and grown.model.covariance is not None:
        result["z"] = _deviations(kind, grown.model)
    return result


def _deviations(kind: str, model: ExtendedModel) -> list[float]:
    assert model.covariance is not None
    size = model.base.plant_size
    effect = model.effects[-1]
    errors = effect.coefficients.ravel() - truth(kind)
    sigma = np.sqrt(np.diag(model.covariance)[size : size + effect.size])
    return [float(z) for z in errors / sigma]


def one_alarm(task: tuple[int, int]) -> dict[str, Any]:
    """One run with nothing hidden."""
    number, seed = task
    condition = dict(CONDITIONS[number])
    generator = np.random.default_rng(seed)
    done, y = _clean(condition.pop("points", 7))
    batches = gather(noisy(y, done, condition.pop("share"), generator, **condition))
    found = diagnose(MODEL, batches, effects(done), seed=seed)
    family = min((one.adjusted_p for one in found.scores), default=1.0)
    own = [one.p_value for one in found.scores]
    return {
        "condition": number,
        "announced": bool(family < 0.05),
        "added": bool(found.announced),
        "family p": family,
        "own p": own[seed % len(own)],
        "lack of fit p": found.lack_of_fit.p_value,
    }


@cache
def _clean(points: int):
    done = experiments(np.random.default_rng(2024), points=points)
    return done, Bench().steady(done)


def one_pair(task: tuple[str, str, int]) -> dict[str, Any]:
    """One run with two effects hidden."""
    hidden, seed = task[:2], task[2]
    batches = measured(hidden, 0.03, np.random.default_rng(seed))
    steps = staircase(MODEL, batches, effects=effects(_design()), largest=3, seed=seed)
    found = [one.effect.kind for one in steps[-1].model.effects]
    last = steps[-1].diagnosis.lack_of_fit
    outside = held_out(hidden)
    return {
        "hidden": list(hidden),
        "found": found,
        "both": set(hidden) <= set(found),
        "at noise floor": last.p_value > 1e-3,
        "p": last.p_value,
        "errors": [relative_error(step.model, outside) for step in steps],
    }


def one_unknown(task: tuple[str, int]) -> dict[str, Any]:
    """One run with an effect hidden that is not in the library."""
    kind, seed = task
    library = [one for one in effects(_design()) if one.kind != kind]
    batches = measured((kind,), 0.03, np.random.default_rng(seed))
    steps = staircase(MODEL, batches, effects=library, largest=2, seed=seed)
    first = steps[0].diagnosis
    return {
        "kind": kind,
        "conclusion": conclusion(steps),
        "confident": first.confident,
        "verdict": first.verdict,
        "added": [one.effect.kind for one in steps[-1].model.effects],
    }


def _work(seed_and_task):
    study, task = seed_and_task
    return {"hits": one_hit, "alarms": one_alarm, "pairs": one_pair, "unknown": one_unknown}[study](task)


def tasks(study: str, runs: int) -> list[Any]:
    """What the runs of a study are."""
    if study == "hits":
        every = [(kind, share) for kind in kinds() for share in SHARES]
        return [(kind, share, 100_000 * n + r) for n, (kind, share) in enumerate(every) for r in range(runs)]
    if study == "alarms":
        return [(number, 100_000 * number + r) for number in range(len(CONDITIONS)) for r in range(runs)]
    if study == "unknown":
        return [(kind, r) for kind in REMOVED for r in range(runs)]
    generator = np.random.default_rng(11)
    return [(*(str(k) for k in generator.choice(kinds(), 2, replace=False)), r) for r in range(runs)]


def _rate(values: Sequence[bool]) -> str:
    return f"{100 * np.mean(values):6.1f} % of {len(values)}"


def report_hits(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates for each noise level, and the confusion at each."""
    summary = {}
    for share in SHARES:
        own = [run for run in runs if run["share"] == share]
        z = np.array([value for run in own for value in run.get("z", [])])
        ratio = [run["error after"] / run["error with the truth"] for run in own if "error with the truth" in run]
        fall = [run["error before"] / run["error after"] for run in own if "error after" in run]
        summary[f"{share:.0%} noise"] = {
            "right effect first": _rate([run["first"] == run["kind"] for run in own]),
            "right effect first by score alone": _rate([run["first by score"] == run["kind"] for run in own]),
            "in the announced set": _rate([run["in set"] for run in own]),
            "mean size of the set": float(np.mean([run["set size"] for run in own])),
            "confident and wrong": _rate([run["confident and wrong"] for run in own]),
            "amplitude in its 95 % interval": _rate(list(abs(z) < 1.96)),
            "median fall of the held-out error": float(np.median(fall)),
            "median error over that of the true structure": float(np.median(ratio)),
            "median seconds": float(np.median([run["seconds"] for run in own])),
            "95 % of seconds": float(np.quantile([run["seconds"] for run in own], 0.95)),
            "confused": sorted({f"{r['kind']} -> {r['first']}" for r in own if r["first"] != r["kind"]}),
        }
    return summary


def report_alarms(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates for each condition, and whether p-values are uniform."""
    summary = {}
    for number, condition in enumerate(CONDITIONS):
        own = [run for run in runs if run["condition"] == number]
        summary[json.dumps(condition)] = {
            "announced": _rate([run["announced"] for run in own]),
            "really added": _rate([run["added"] for run in own]),
            "lack of fit below 5 %": _rate([run["lack of fit p"] < 0.05 for run in own]),
            "p of uniformity, one effect": float(kstest([run["own p"] for run in own], "uniform").pvalue),
            "p of uniformity, lack of fit": float(kstest([run["lack of fit p"] for run in own], "uniform").pvalue),
        }
    return summary


def report_others(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates of every yes-or-no figure."""
    flags = [name for name, value in runs[0].items() if isinstance(value, bool)]
    summary: dict[str, Any] = {name: _rate([run[name] for run in runs]) for name in flags}
    if "conclusion" in runs[0]:
        summary["not in the library"] = _rate([run["conclusion"] == "not in the library" for run in runs])
    return summary


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", choices=["hits", "alarms", "pairs", "unknown"])
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--output", type=Path, default=None)
    options = parser.parse_args()
    strengths()
    work = [(options.study, task) for task in tasks(options.study, options.runs)]
    runs = over(_work, work, options.workers)
    report = {"hits": report_hits, "alarms": report_alarms}.get(options.study, report_others)
    summary = report(runs)
    print(json.dumps(summary, indent=1))
    if options.output is not None:
        options.output.write_text(json.dumps({"summary": summary, "runs": runs}, indent=1) + "\n")


if __name__ == "__main__":
    main()
