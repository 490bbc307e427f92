"""A set of effects looked over once more: what others replace, or has become needless, is exchanged or dropped."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from identification.comparison.batch import Batch
from identification.diagnosis.evidence import Evidence, effective_count, refit_short_list
from identification.diagnosis.scores import score_tests
from identification.diagnosis.signatures import candidates
from identification.effects.library import library
from identification.effects.second_variable import with_logged
from identification.extension.fit import Fit, fit
from identification.places.place import Effect
from identification.places.steady import NoSteadyStateError

ROUNDS, PROPOSED = 3, 4
WORTH = 6.0


def looked_over(
    found: Fit, batches: Sequence[Batch], effects: Sequence[Effect] | None, degree: int, seed: int
) -> Fit | None:
    """The best fit that dropping or exchanging single effects leads to; None where the set is best as it is.

    Effects that were added one by one were each the best at their time, so that one which imitated two others at once
    may stand where they belong. Every effect in turn is taken out for good where that lowers BIC, and what then scores
    most is put in its place where that lowers it by more than six, a strong reason [KassRaftery1995].
    """
    best, changed = found, False
    for _ in range(ROUNDS):
        better = _better(best, batches, effects, degree, seed)
        if better is None:
            break
        best, changed = better, True
    return best if changed else None


def _better(
    found: Fit, batches: Sequence[Batch], effects: Sequence[Effect] | None, degree: int, seed: int
) -> Fit | None:
    count = effective_count(found.rows, found.residual)
    for i in range(len(found.model.effects)):
        try:
            trials = _without(found, i, batches, effects, degree, seed)
        except NoSteadyStateError:
            continue
        best = min(trials, key=lambda one: _price(one, count))
        worth = WORTH if len(best.model.effects) == len(found.model.effects) else 0.0
        if _price(best, count) < _price(found, count) - worth:
            return best
    return None


def _without(
    found: Fit, i: int, batches: Sequence[Batch], effects: Sequence[Effect] | None, degree: int, seed: int
) -> list[Fit]:
    """The fit without the i-th effect, and with each of what is then announced instead."""
    kept = found.model.effects[:i] + found.model.effects[i + 1 :]
    model = replace(found.model, effects=kept, joint_covariance=None)
    bare = fit(model, found.rows, start=found.flows)
    if not kept:
        return [bare]
    judged = candidates(bare, with_logged(library() if effects is None else effects, batches), degree)
    scores = score_tests(bare, [one for one in judged if one.signatures], np.random.default_rng(seed))
    proposed = [
        one for one in refit_short_list(bare, scores, PROPOSED).evidence if one.announceable and not one.at_bound
    ]
    instead = [one for one in proposed if _kind(one) != found.model.effects[i].effect.kind]
    return [bare, *(fit(one.fit.model, found.rows, start=one.fit.flows) for one in instead)]


def _kind(one: Evidence) -> str:
    return one.fit.model.effects[-1].effect.kind


def _price(one: Fit, count: float) -> float:
    """BIC of all effects together."""
    parameters = sum(len(effect.parameters()) for effect in one.model.effects)
    return one.cost * count / one.rows.count + parameters * float(np.log(count))
