"""False alarms: nothing is hidden; how often is something announced, and are the p-values uniform?"""

from functools import cache
from typing import Any

import numpy as np
from scipy.stats import kstest

from benchmarks.virtual_bench.bench import Bench, FirstOrderBench, noisy
from benchmarks.virtual_bench.figures import most, rate
from benchmarks.virtual_bench.study import FIRST_ORDER, MODEL, design, effects
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import Diagnosis, diagnose

COLOURED = 0.9
ORDERS = (1, 2)
CONDITIONS: tuple[dict[str, Any], ...] = (
    *({"order": n, "share": s, "colour": c} for n in ORDERS for s in (0.01, 0.03, 0.1, 0.3) for c in (0.0, COLOURED)),
    *({"order": n, "share": 0.03, "colour": c, "points": m} for n in ORDERS for m in (3, 15) for c in (0.0, COLOURED)),
    *({"order": n, "share": 0.03, "heavy": True} for n in ORDERS),
    *({"order": n, "share": 0.03, "spread": 5.0} for n in ORDERS),
)
LEVEL = 0.05


def tasks(runs: int) -> list[tuple[int, int]]:
    """Condition and seed of every run."""
    return [(number, 100_000 * number + r) for number in range(len(CONDITIONS)) for r in range(runs)]


def label(condition: dict[str, Any]) -> str:
    """A condition in words."""
    noise = "coloured" if condition.get("colour") else "white"
    noise = "Student t, 3 dof" if condition.get("heavy") else noise
    noise = "white, fivefold over p" if condition.get("spread") else noise
    plant = ("", "first", "second")[condition["order"]]
    return f"{plant} order, {condition.get('points', 7)} points, {condition['share']:.0%} {noise}"


def one(task: tuple[int, int]) -> dict[str, Any]:
    """One run."""
    number, seed = task
    condition = dict(CONDITIONS[number])
    order, points, share = condition.pop("order"), condition.pop("points", 7), condition.pop("share")
    done, y = _clean(order, points)
    batches = gather(noisy(y, done, share, np.random.default_rng(seed), **condition))
    found = diagnose(MODEL if order == 2 else FIRST_ORDER, batches, effects(done), seed=seed, material=0.0)
    return {"condition": number, "seed": seed, **_seen(found)}


def _seen(found: Diagnosis) -> dict[str, Any]:
    own = {one.candidate.effect.kind: one for one in found.scores}
    return {
        "announced": [one.score.candidate.effect.kind for one in found.announced],
        "confident": found.confident,
        "family p": min((one.adjusted_p for one in found.scores), default=1.0),
        "lack of fit p": found.lack_of_fit.p_value,
        "p": {kind: float(f"{one.p_value:.4g}") for kind, one in own.items()},
        "variants": {kind: max(len(one.candidate.signatures), one.candidate.looked_at) for kind, one in own.items()},
    }


@cache
def _clean(order: int, points: int):
    done = design(points)
    return done, (Bench() if order == 2 else FirstOrderBench()).steady(done)


def summary(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates of each condition against what five per cent explain, and Kolmogorov–Smirnov tests of uniformity."""
    found = {}
    for number in sorted({run["condition"] for run in runs}):
        own = [run for run in runs if run["condition"] == number]
        announced = rate([bool(run["announced"]) for run in own])
        found[label(CONDITIONS[number])] = {
            "announced": announced,
            "within five per cent": announced["percent"] <= most(LEVEL, len(own)),
            "family test below five per cent": rate([run["family p"] < LEVEL for run in own]),
            "announced with confidence": rate([run["confident"] for run in own]),
            "lack of fit below five per cent": rate([run["lack of fit p"] < LEVEL for run in own]),
            "p of uniformity": {
                "lack of fit": uniformity([run["lack of fit p"] for run in own]),
                "family": uniformity([run["family p"] for run in own]),
                "one effect at random": uniformity(at_random(own)),
                "least of effects with one variant, times their number": least_uniformity(own),
            },
        }
    return found


def uniformity(values: list[float]) -> float:
    """The p-value of Kolmogorov and Smirnov's test."""
    return float(kstest(values, "uniform").pvalue)


def at_random(runs: list[dict[str, Any]]) -> list[float]:
    """The p-value of one effect a run, drawn among those that are visible."""
    draws = ((run, np.random.default_rng(run["seed"] + 1)) for run in runs)
    return [run["p"][str(generator.choice(sorted(run["p"])))] for run, generator in draws]


def least_uniformity(runs: list[dict[str, Any]]) -> float:
    """The smallest p-value of uniformity over the effects with one variant, with Bonferroni's factor."""
    kinds = [k for k in runs[0]["p"] if all(run["variants"].get(k) == 1 for run in runs)]
    return min(1.0, len(kinds) * min(uniformity([run["p"][kind] for run in runs]) for kind in kinds))
