"""Where strong effects on signals are looked for: the measured output in their laws, and their refits from there."""

from collections.abc import Sequence

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.diagnosis.measured_law import measured_fit
from identification.diagnosis.scores import Score
from identification.diagnosis.signatures import tangent_space
from identification.extension.fit import Fit
from identification.extension.rows import effect_tangents
from identification.places.nonlinear import Added
from identification.places.place import Effect
from identification.places.placed import PlacedEffect
from identification.places.recorder import Recorder

STRONG = 3.0
NEARLY, SEVERAL = 0.5, 1
CARRIED_ON, HOPEFUL = 4, 4.0


def strong_starts(base: Fit, scores: Sequence[Score]) -> dict[int, list[Fit]]:
    """Fits with the measured output in the law, best effect first, by the place of its score in `scores`.

    Where noise explains the misfit, or only a little of it is more, small amplitudes lead there as well and nothing is
    scanned. Otherwise every variant of an effect on signals is projected on what the equation of motion leaves with θ
    alone; the best of each are fitted with θ, and of the effects those that then leave least are kept.
    """
    if not much_is_missing(base):
        return {}
    alone = measured_fit(base.model, base.rows)
    space = tangent_space(alone)
    left = {i: _least(alone, space, one) for i, one in enumerate(scores) if on_signals(one.candidate.effect)}
    most = max((explained for _, explained in left.values()), default=0.0)
    kept = [i for i in left if left[i][1] > NEARLY * most]
    found = {i: [measured_fit(base.model.plus(one), base.rows) for one in left[i][0]] for i in kept}
    reached = {i: min(_energy(one) for one in found[i]) for i in kept}
    ordered = sorted(kept, key=lambda i: reached[i])[:CARRIED_ON]
    return {i: sorted(found[i], key=_energy)[:SEVERAL] for i in ordered if reached[i] <= HOPEFUL * reached[ordered[0]]}


def _energy(found: Fit) -> float:
    return float(found.residual @ found.residual)


def much_is_missing(base: Fit) -> bool:
    """Whether much more than noise is left of records that repeat, so that laws are to follow the measured output."""
    return all(map(_periodic, base.rows.batches)) and _energy(base) > STRONG * base.rows.count


def _periodic(batch: Batch) -> bool:
    return batch.signals is not None and batch.scaled and batch.repeats and batch.measured_law is None


def on_signals(effect: Effect) -> bool:
    """Whether it acts on signals, and neither only adds to the output nor lies in how that is recorded."""
    return effect.needs_records and not isinstance(effect, Added | Recorder)


def _least(alone: Fit, space: FloatArray, score: Score) -> tuple[list[PlacedEffect], float]:
    """The variants of an effect that explain most of ‖r‖², and how much."""
    sizes = []
    variants = [signature.placed for signature in score.candidate.signatures]
    for one in variants:
        changes = effect_tangents(one, alone.rows, alone.flows, further=False)
        left = changes - (changes @ space.T) @ space
        solution = np.linalg.lstsq(left.T, alone.residual, rcond=1e-10)[0]
        wrong = one.effect.sign and one.degree == 0 and one.effect.sign * solution[0] < 0
        sizes.append(0.0 if wrong else float(solution @ (left @ alone.residual)))
    ordered = np.argsort(-np.array(sizes), kind="stable")[:SEVERAL]
    return [variants[i] for i in ordered if sizes[i] > 0], max(sizes, default=0.0)
