"""Effects added one by one until the noise explains what is left; every step is kept."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from identification.comparison.batch import EXCITED, Batch
from identification.diagnosis.diagnose import STRICT, Diagnosis, diagnose
from identification.extension.fit import Fit, fit
from identification.models.model import Model
from identification.places.place import Effect
from identification.places.simulate import NoSteadyStateError

LARGEST = 4
NEGLIGIBLE = 0.005


@dataclass(frozen=True, eq=False)
class Step:
    """A version of the model: its fit, relative errors on fitted and held-out data, and the diagnosis of what it lacks.

    Errors are root mean squares of Y − Ŷ at the excited lines over those of Y; `held_out_error` None without such data.
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
    """‖Y − Ŷ‖/‖Y‖ over the excited lines; each line by its own size where no noise is known (relative weighting)."""
    error = size = 0.0
    for batch in batches:
        used = np.where((batch.classes == EXCITED) & np.isfinite(batch.variances), 1.0, 0.0)
        if not batch.scaled:
            used = used / batch.variances
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
    """Diagnose, add the announced effect of most weight, fit θ and all effects together, and again.

    Ends at the noise floor (no effect is announced), after `largest` effects, or when an effect would raise the error
    on held-out data or leave the model without a steady state there.
    """
    first = diagnose(model, batches, effects, degree, seed)
    steps = [_step(first.base, batches, held_out, first)]
    while (best := steps[-1].diagnosis.best) is not None and len(steps) <= largest:
        try:
            grown = refined(best.fit)
            found = _step(grown, batches, held_out, diagnose(grown.model, batches, effects, degree, seed))
        except NoSteadyStateError:
            break
        if _rises(found.held_out_error, steps[-1].held_out_error):
            break
        steps.append(found)
    return tuple(steps)


def refined(found: Fit) -> Fit:
    """A fit of the short list carried on to its minimum, with the covariance of all its parameters."""
    return fit(found.model, found.rows, exact=found.rows.scaled, start=found.flows)


def conclusion(steps: Sequence[Step]) -> Literal["nothing missing", "explained", "not in the library"]:
    """What the staircase has come to: effects explain what is missing only when the last model passes the test.

    Where the size of the noise is not known there is no such test, and effects that were added count as explaining.
    """
    last, first = steps[-1].diagnosis, steps[0].diagnosis
    excess = last.lack_of_fit.statistic - last.lack_of_fit.degrees_of_freedom
    at_first = first.lack_of_fit.statistic - first.lack_of_fit.degrees_of_freedom
    if last.lack_of_fit.p_value >= STRICT or excess <= NEGLIGIBLE * at_first:
        return "explained" if len(steps) > 1 else "nothing missing"
    return "not in the library"


def _step(found: Fit, batches: Sequence[Batch], held_out: Sequence[Batch], diagnosis: Diagnosis) -> Step:
    outside = relative_error(found.model, held_out) if held_out else None
    return Step(found, relative_error(found.model, batches), outside, diagnosis)


def _rises(new: float | None, old: float | None) -> bool:
    return new is not None and old is not None and new > old
