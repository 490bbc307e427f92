"""One effect hidden at a time: is it named first, is what is added right, and does the error fall?"""

from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.virtual_bench.bench import Bench, experiments, noisy
from benchmarks.virtual_bench.figures import quantiles, rate
from benchmarks.virtual_bench.hidden import HIDDEN
from benchmarks.virtual_bench.study import MODEL, design, effects, measured, steady, strengths
from identification.comparison.batch import Batch
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import Diagnosis, diagnose
from identification.diagnosis.staircase import refined, relative_error
from identification.extension.fit import Fit, fit
from identification.models.model import Model
from identification.places.placed import placed

INVISIBLE = {"time_base"}
TIED_TO_RECORDS = {"misplaced_point", "second_variable", "gain_drift", "hum"}
SHARES = (0.01, 0.03, 0.1)
QUANTILE = 1.959963984540054
RISE = 1.001


def kinds() -> list[str]:
    """The effects that the bench can hide and its experiment can show."""
    return [kind for kind in HIDDEN if kind not in INVISIBLE]


def tasks(runs: int, shares: tuple[float, ...] = SHARES) -> list[tuple[str, float, int]]:
    """Hidden effect, noise and seed of every run; the same seeds whichever noise levels are asked for."""
    every = [(kind, share) for kind in kinds() for share in SHARES]
    return [(*one, 100_000 * n + r) for n, one in enumerate(every) if one[1] in shares for r in range(runs)]


@cache
def held_out(hidden: tuple[str, ...]) -> tuple[Batch, ...]:
    """Other operating points, level and lines, nearly without noise; effects tied to records keep theirs."""
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


def one(task: tuple[str, float, int]) -> dict[str, Any]:
    """One run."""
    kind, share, seed = task
    batches = measured((kind,), share, np.random.default_rng(seed))
    start = perf_counter()
    found = diagnose(MODEL, batches, effects(design()), seed=seed, material=0.0)
    seconds = perf_counter() - start
    names = [one.score.candidate.effect.kind for one in found.announced]
    by_score = max(found.scores, key=lambda one: one.statistic).candidate.effect.kind
    result: dict[str, Any] = {
        "kind": kind,
        "share": share,
        "seed": seed,
        "first": names[0] if names else "nothing",
        "first by score": by_score,
        "set": names,
        "verdict": found.verdict,
        "confident": found.confident,
        "seconds": seconds,
    }
    return result | _added(kind, found) if found.best is not None else result


def _added(kind: str, found: Diagnosis) -> dict[str, Any]:
    assert found.best is not None
    outside = held_out((kind,))
    grown = refined(found.best.fit)
    right = grown if found.best.score.candidate.effect.kind == kind else _true_structure(kind, found)
    result: dict[str, Any] = {
        "error before": relative_error(found.base.model, outside),
        "error after": relative_error(grown.model, outside),
    }
    if right is not None:
        result["error of the true structure"] = relative_error(right.model, outside)
    if right is grown and grown.model.joint_covariance is not None:
        result["z"] = _deviations(kind, grown.model)
    return result


def _true_structure(kind: str, found: Diagnosis) -> Fit | None:
    """The fit with the effect that is hidden: of the short list, or from the best variant of its score."""
    listed = [one.fit for one in found.evidence if one.score.candidate.effect.kind == kind]
    if listed:
        return refined(listed[0])
    for score in found.scores:
        if score.candidate.effect.kind == kind:
            start = placed(score.signature.placed.effect, 0, 1)
            return fit(found.base.model.plus(start), found.base.rows, exact=True)
    return None


def _deviations(kind: str, model: Model) -> list[float]:
    assert model.joint_covariance is not None
    size = model.plant_size
    effect = model.effects[-1]
    errors = effect.coefficients.ravel() - truth(kind)
    sigma = np.sqrt(np.diag(model.joint_covariance)[size : size + effect.size])
    return [float(z) for z in errors / sigma]


def summary(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates, errors and calibration at each noise level."""
    levels = sorted({run["share"] for run in runs})
    return {f"{share:.0%} noise": _at([run for run in runs if run["share"] == share]) for share in levels}


def _at(runs: list[dict[str, Any]]) -> dict[str, Any]:
    every = [by_kind(runs, kind) for kind in sorted({run["kind"] for run in runs})]
    added = [run for run in runs if "error after" in run]
    inside = [abs(z) < QUANTILE for run in runs for z in run.get("z", [])]
    return {
        "effects": len(every),
        "runs of each": min(map(len, every)),
        "right effect first": rate([run["first"] == run["kind"] for run in runs]),
        "right effect first by score alone": rate([run["first by score"] == run["kind"] for run in runs]),
        "right effect in the announced set": rate([run["kind"] in run["set"] for run in runs]),
        "mean size of the set": float(np.mean([len(run["set"]) for run in runs])),
        "confident and wrong": rate([run["confident"] and run["first"] != run["kind"] for run in runs]),
        "amplitude in its 95 % interval": rate(inside),
        "held-out error falls by a factor of, median of every effect": quantiles([fall(one) for one in every]),
        "held-out error over that of the true structure, worst median of an effect": max(map(excess, every)),
        "held-out error rises": rate([run["error after"] > RISE * run["error before"] for run in added]),
        "seconds": quantiles([run["seconds"] for run in runs]),
        "confused": sorted({f"{r['kind']} -> {r['first']}" for r in runs if r["first"] != r["kind"]}),
    }


def by_kind(runs: list[dict[str, Any]], kind: str) -> list[dict[str, Any]]:
    """The runs in which this effect was hidden."""
    return [run for run in runs if run["kind"] == kind]


def fall(runs: list[dict[str, Any]]) -> float:
    """Median factor by which the held-out error falls."""
    return float(np.median([run["error before"] / run["error after"] for run in runs if "error after" in run]))


def excess(runs: list[dict[str, Any]]) -> float:
    """Median held-out error over that of a model fitted with the true structure."""
    known = [run for run in runs if "error of the true structure" in run]
    return float(np.median([run["error after"] / run["error of the true structure"] for run in known]))
