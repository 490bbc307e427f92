"""Two effects hidden at once, drawn at random among all that the bench can hide and show."""

from typing import Any

import numpy as np

from benchmarks.virtual_bench.figures import quantiles, rate
from benchmarks.virtual_bench.hits import held_out, kinds
from benchmarks.virtual_bench.study import MODEL, design, effects, measured
from identification.diagnosis.staircase import relative_error, staircase
from identification.models.model import Model

SHARE = 0.03
FLOOR = 1e-3


def tasks(runs: int) -> list[tuple[str, str, int]]:
    """The pairs."""
    generator = np.random.default_rng(11)
    return [(*(str(k) for k in generator.choice(kinds(), 2, replace=False)), r) for r in range(runs)]


def one(task: tuple[str, str, int]) -> dict[str, Any]:
    """One run: effects are added until the noise floor, then held against data that were not fitted."""
    hidden, seed = task[:2], task[2]
    batches = measured(hidden, SHARE, np.random.default_rng(seed))
    steps = staircase(MODEL, batches, effects=effects(design()), largest=3, seed=seed)
    last = steps[-1].diagnosis
    found = [one.effect.kind for one in steps[-1].model.effects]
    return {
        "hidden": list(hidden),
        "seed": seed,
        "found": found,
        "both found": set(hidden) <= set(found),
        "one found": bool(set(hidden) & set(found)),
        "nothing else added": set(found) <= set(hidden),
        "error at the noise floor": last.lack_of_fit.p_value > FLOOR,
        "p": last.lack_of_fit.p_value,
        "sets": [[one.score.candidate.effect.kind for one in step.diagnosis.announced] for step in steps],
        "held-out errors": [_error(step.model, hidden) for step in steps],
    }


def _error(model: Model, hidden: tuple[str, ...]) -> float:
    return relative_error(model, held_out(hidden))


def summary(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates of what is found, and how far the error falls."""
    flags = [name for name, value in runs[0].items() if isinstance(value, bool)]
    errors = [run["held-out errors"] for run in runs]
    return {
        **{name: rate([run[name] for run in runs]) for name in flags},
        "both and at the noise floor": rate([run["both found"] and run["error at the noise floor"] for run in runs]),
        "held-out error falls by a factor of": quantiles([one[0] / one[-1] for one in errors]),
        "held-out error never rises": rate([bool(np.all(np.diff(one) <= 0)) for one in errors]),
        "missed": [f"{' + '.join(r['hidden'])} -> {' + '.join(r['found'])}" for r in runs if not r["both found"]],
    }
