"""What the loop says of a case, as the fields of an answer."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.cases.predicting import predicted
from benchmarks.cases.reading import Case
from identification.arrays import ComplexArray, FloatArray
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import PARTLY
from identification.diagnosis.staircase import Step, conclusion, staircase
from identification.effects.misplaced_point import MisplacedPoint
from identification.models.model import Model
from identification.places.placed import PlacedEffect


@dataclass(frozen=True)
class Answer:
    """One entry of the results, with the predictions by the names of their arrays."""

    said: dict[str, Any]
    predictions: dict[str, FloatArray | ComplexArray] = field(default_factory=dict)


def answer(case: Case, seed: int = 0) -> Answer:
    """Diagnose, add what is announced, diagnose again; then predict without and with what was added."""
    began = perf_counter()
    steps = staircase(case.model, gather(case.fitted, logged=case.logged), seed=seed)
    found, first, last = announced(steps), steps[0], steps[-1]
    predictions, failures = {}, []
    for when, model in (("before", first.model), ("after", last.model)):
        for one in case.held_out:
            try:
                predictions[f"{when}_{one.name}"] = predicted(model, one)
            except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
                failures.append(f"{when}, {one.name}: {error}")
    said = {
        "case": case.name,
        "verdict": verdict(steps),
        "announced": found,
        "confident": bool(found) and first.diagnosis.confident,
        "added": [added(last.model, one, i) for i, one in enumerate(last.model.effects)],
        "fittedErrors": [step.error for step in steps],
        "seconds": perf_counter() - began,
        "reason": "; ".join(failures),
    }
    return Answer(said, predictions)


def not_judged(name: str, error: Exception) -> Answer:
    """The answer where the loop broke: it says why."""
    reason = f"{type(error).__name__}: {error}"
    said = {"case": name, "verdict": "cannotBeJudged", "announced": [], "confident": False, "added": []}
    return Answer({**said, "reason": reason})


def announced(steps: Sequence[Step]) -> list[str]:
    """The kinds that were added, in order, then those that could not be told apart from the first of them."""
    kinds = [one.effect.kind for one in steps[-1].model.effects]
    alike = [one.score.candidate.effect.kind for one in steps[0].diagnosis.announced]
    varies = steps[-1].diagnosis.variation
    kinds += [] if varies is None else [varies.effect.kind]
    return list(dict.fromkeys([*kinds, *(alike if not kinds or kinds[0] in alike else [])]))


def verdict(steps: Sequence[Step]) -> str:
    """The verdict of the first diagnosis where nothing was added, else what the whole staircase has come to."""
    if len(steps) == 1:
        return _camel(steps[0].diagnosis.verdict)
    ended: str = conclusion(steps)
    if ended == "not in the library" and _explained(steps) >= PARTLY:
        ended = "partly explained"
    return _camel(ended)


def _explained(steps: Sequence[Step]) -> float:
    """The share of what noise does not explain that the effects took away."""
    first, last = (step.diagnosis.lack_of_fit for step in (steps[0], steps[-1]))
    excess = first.statistic - first.degrees_of_freedom
    return (first.statistic - last.statistic) / excess if excess > 0 else 0.0


def _camel(words: str) -> str:
    head, *tail = words.split()
    return head + "".join(word.capitalize() for word in tail)


def added(model: Model, one: PlacedEffect, number: int) -> dict[str, Any]:
    """Kind, mean amplitude with its standard error where there is one of it, and the place of a misplaced point."""
    single = one.effect.shapes == 1
    return {
        "kind": one.effect.kind,
        "amplitude": float(one.coefficients[0, 0]) if single else None,
        "standardError": _deviation(model, number) if single else None,
        "at": _logged_at(model, one.effect) if isinstance(one.effect, MisplacedPoint) else None,
    }


def _deviation(model: Model, number: int) -> float | None:
    if model.joint_covariance is None:
        return None
    before = sum(len(one.parameters()) for one in model.effects[:number])
    place = model.plant_size + before
    return float(np.sqrt(max(model.joint_covariance[place, place], 0.0)))


def _logged_at(model: Model, effect: MisplacedPoint) -> float:
    variable = model.dependence.variables[effect.variable]
    return variable.minimum + (effect.point + 1) / 2 * (variable.maximum - variable.minimum)
