"""Effects added one by one until the noise explains what is left; every step is kept."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.comparison.batch import EXCITED, Batch
from identification.diagnosis.cross_validation import bears_out
from identification.diagnosis.diagnose import Diagnosis, diagnose
from identification.diagnosis.evidence import LONGER, Evidence, on_bound
from identification.diagnosis.exchange import looked_over
from identification.diagnosis.missing_law import is_law
from identification.diagnosis.penalised import is_penalised
from identification.diagnosis.remainder import MATERIAL
from identification.diagnosis.verdict import Verdict
from identification.effects.library import library
from identification.extension.fit import Fit, fit
from identification.extension.settle import settled
from identification.models.model import Model
from identification.places.place import Effect
from identification.places.steady import NoSteadyStateError

LARGEST = 4
MOSTLY = 0.25
HALF = 0.5


@dataclass(frozen=True, eq=False)
class Step:
    """A version of the model: its fit, relative errors on fitted and held-out data, and the diagnosis of what it lacks.

    Errors are those of `relative_error`; `held_out_error` None without such data.
    """

    fit: Fit
    error: float
    held_out_error: float | None
    diagnosis: Diagnosis

    @property
    def model(self) -> Model:
        """The model of this step."""
        return self.fit.model


def relative_error(model: Model, batches: Sequence[Batch]) -> float:
    """The error of a model, everywhere: ‖Y − Ŷ‖/‖Y‖ over the excited lines that are compared, of all measurements."""
    error = size = 0.0
    for batch in settled(model, batches, refit=False):
        used = np.where((batch.classes == EXCITED) & np.isfinite(batch.variances), 1.0, 0.0)
        error += float(np.sum(used * abs(batch.outputs - model.output(batch)) ** 2))
        size += float(np.sum(used * abs(batch.outputs) ** 2))
    return float(np.sqrt(error / size))


def staircase(
    model: Model,
    batches: Sequence[Batch],
    held_out: Sequence[Batch] = (),
    effects: Sequence[Effect] | None = None,
    degree: int = 0,
    largest: int = LARGEST,
    seed: int = 0,
) -> tuple[Step, ...]:
    """Diagnose, add the best announced effect that cross-validation bears out, fit all together, and again.

    Ends when no effect is announced, after `largest` effects, or when every announced effect would raise the error on
    data that were left out of the fit (`cross_validation`) or leave the model without a steady state. Where several
    were added, the set is looked over once more at the end, and the steps are those to what it has become. Where a
    curve without a name is announced, the way over names is kept where one or two of them explain what is missing, or
    where the curve does not and leaves more than half of what they leave. Held-out data are looked at for the report
    only.
    """
    chosen = tuple(library() if effects is None else effects)
    first = diagnose(model, batches, chosen, degree, seed)
    start = _step(first.base, batches, held_out, first)
    names = tuple(one for one in chosen if not is_penalised(one))

    def climbed(among: tuple[Effect, ...], announced: Sequence[Evidence], most: int = largest) -> tuple[Step, ...]:
        def step(found: Fit) -> Step:
            return _step(found, batches, held_out, diagnose(found.model, batches, among, degree, seed))

        steps = _climbed(start, announced, step, most)
        return steps if len(steps) < 3 else _looked_over(steps, batches, among, degree, seed, step)

    if not (first.announced and is_law(first.announced[0])):
        return climbed(chosen, first.announced)
    lawful, ended = None, climbed(names, first.named, 1)[-1].diagnosis
    if not (ended.left.acceptable or ended.verdict == "explained"):
        lawful = climbed(chosen, first.announced)
        if len(lawful) > 1 and lawful[-1].diagnosis.left.acceptable:
            return lawful
    named = climbed(names, first.named)
    if named[-1].diagnosis.left.acceptable:
        return named
    lawful = lawful or climbed(chosen, first.announced)
    return lawful if _better(lawful, named) else named


def _climbed(start: Step, announced: Sequence[Evidence], step: Callable[[Fit], Step], largest: int) -> tuple[Step, ...]:
    steps = [start]
    while announced and len(steps) <= largest:
        grown = _grown(steps[-1].diagnosis, announced)
        if grown is None:
            break
        try:
            steps.append(step(grown))
        except NoSteadyStateError:
            break
        announced = steps[-1].diagnosis.announced
    return tuple(steps)


def _better(lawful: Sequence[Step], named: Sequence[Step]) -> bool:
    """Whether the way over the law ends with what is acceptable, or leaves less than half of what names leave."""
    left = lawful[-1].diagnosis.left
    return len(lawful) > 1 and (left.acceptable or left.share < HALF * named[-1].diagnosis.left.share)


def _looked_over(
    steps: Sequence[Step],
    batches: Sequence[Batch],
    effects: Sequence[Effect] | None,
    degree: int,
    seed: int,
    step: Callable[[Fit], Step],
) -> tuple[Step, ...]:
    """The steps to the set of effects that exchanging and dropping leads to, the one that explains most first."""
    other = looked_over(steps[-1].fit, batches, effects, degree, seed)
    if other is None:
        return tuple(steps)
    found = refined(other)
    path, left = [steps[0]], list(found.model.effects)
    while len(left) > 1:
        trials = [fit(path[-1].model.plus(one), found.rows) for one in left]
        best = min(range(len(left)), key=lambda i: trials[i].cost)
        del left[best]
        path.append(step(refined(trials[best])))
    return (*path, step(found))


def _grown(found: Diagnosis, announced: Sequence[Evidence]) -> Fit | None:
    """The model with the first of the announced effects that does not raise the error on data left out of the fit.

    What was held by an end of its physical range is announced and not built on; so is, beside effects that are there
    already, what changes the output by less than is material.
    """
    for one in (each for each in announced if not each.at_bound):
        try:
            grown = refined(one.fit)
            matters = not found.base.model.effects or _changed(found.base, grown) >= MATERIAL
            if grown.outcome.ok and matters and bears_out(found.base, grown):
                return grown
        except NoSteadyStateError:
            continue
    return None


def _changed(base: Fit, grown: Fit) -> float:
    """‖Ŷ_grown − Ŷ‖/‖Y‖ over all compared lines."""
    change = size = 0.0
    for batch, before, after in zip(base.rows.batches, base.flows, grown.flows, strict=True):
        used = np.isfinite(batch.variances)
        change += float(np.sum(abs(after.output - before.output)[used] ** 2))
        size += float(np.sum(abs(batch.outputs)[used] ** 2))
    return float(np.sqrt(change / size))


def refined(found: Fit) -> Fit:
    """A fit of the short list carried on to its minimum, with the covariance of all its parameters.

    Batches that follow from the model are settled under the one with the effect first.
    """
    rows = replace(found.rows, batches=settled(found.model, found.rows.batches))
    return fit(found.model, rows, iterations=LONGER, exact=rows.scaled, start=found.flows)


def conclusion(steps: Sequence[Step]) -> Verdict:
    """What the staircase has come to: effects explain what is missing only when the last model leaves noise.

    Or so little that it does not matter; "partly explained" where effects took away three quarters of it or more.
    """
    last = steps[-1].diagnosis
    if len(steps) == 1:
        return last.verdict
    if last.verdict == "cannot be judged" and not last.left.acceptable:
        return "cannot be judged"
    if last.left.acceptable and not last.announced:
        held = any(on_bound(one, last.base) for one in last.base.model.effects)
        return "partly explained" if held else "explained"
    lacked = steps[0].diagnosis.left.share
    return "partly explained" if last.left.share <= MOSTLY * lacked else "not in the library"


def _step(found: Fit, batches: Sequence[Batch], held_out: Sequence[Batch], diagnosis: Diagnosis) -> Step:
    outside = relative_error(found.model, held_out) if held_out else None
    return Step(found, relative_error(found.model, batches), outside, diagnosis)
