"""Whether a model with an effect more predicts what it was not fitted to."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from identification.arrays import BoolArray, FloatArray
from identification.comparison.batch import EXCITED, Batch
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows

MOST_FOLDS, BLOCKS = 5, 4
ITERATIONS = 8
TOLERATED = 0.005
UNHEARD = 1e24


def bears_out(base: Fit, grown: Fit) -> bool:
    """Whether an effect lowers the whitened error on data left out, and does not raise the plain one.

    Operating points are left out one after the other (in `MOST_FOLDS` groups where there are more), blocks of
    neighbouring lines where there are fewer than three; θ and the effects are fitted to the others
    [Stone1974]. Whitened: Σ‖r‖² over all compared lines; plain: ‖Y − Ŷ‖ at the excited ones, by no more than half a
    per cent, which is what an effect that acts at other lines may do to it by chance.
    """
    folds = _folds(base.rows.batches)
    before, after = (_errors(one, folds) for one in (base, grown))
    return bool(after[0] < before[0] and after[1] <= (1 + TOLERATED) * before[1])


def cross_validated(found: Fit) -> float:
    """‖Y − Ŷ‖/‖Y‖ at the excited lines of data left out of the fit, in the folds of `bears_out`."""
    batches = found.rows.batches
    size = sum(float(np.sum(abs(batch.outputs[_used(batch)]) ** 2)) for batch in batches)
    return float(_errors(found, _folds(batches))[1] / np.sqrt(size))


def _folds(batches: Sequence[Batch]) -> list[list[BoolArray]]:
    """For each fold and batch which lines (M, K) are left out."""
    points = np.unique(np.concatenate([batch.points for batch in batches]), axis=0)
    if len(points) >= 3:
        count = min(len(points), MOST_FOLDS)
        return [[_at(batch, points[i::count]) for batch in batches] for i in range(count)]
    low = np.log(min(batch.band[0] for batch in batches))
    high = np.log(max(batch.band[1] for batch in batches))
    found = []
    for i in range(BLOCKS):
        part = [np.floor(2 * BLOCKS * (_logarithm(b) - low) / (high - low + 1e-9)) % BLOCKS == i for b in batches]
        found.append([np.broadcast_to(one, batch.outputs.shape) for one, batch in zip(part, batches, strict=True)])
    return found


def _logarithm(batch: Batch) -> FloatArray:
    return np.asarray(np.log(np.maximum(batch.omega, batch.band[0] / 2)))


def _at(batch: Batch, points: FloatArray) -> BoolArray:
    chosen = np.any(np.all(batch.points[:, None] == points, axis=-1), axis=1)
    return np.repeat(chosen[:, None], len(batch.omega), axis=1)


def _used(batch: Batch) -> BoolArray:
    return np.asarray((batch.classes == EXCITED) & np.isfinite(batch.variances))


def _errors(found: Fit, folds: Sequence[Sequence[BoolArray]]) -> tuple[float, float]:
    """Whitened sum of squares and plain root of the sum of squares of what was left out."""
    whitened = plain = 0.0
    for fold in folds:
        pairs = list(zip(found.rows.batches, fold, strict=True))
        kept = tuple(replace(b, variances=np.where(left_out, UNHEARD, 1.0) * b.variances) for b, left_out in pairs)
        rows = Rows(kept, found.rows.scales)
        model = fit(found.model, rows, iterations=ITERATIONS, tolerance=0.1, start=found.flows).model
        for (batch, left_out), scale, flow in zip(pairs, found.rows.scales, found.flows, strict=True):
            used = left_out & np.isfinite(batch.variances)
            off = np.where(used, batch.outputs - model.respond(batch, flow).output, 0.0)
            whitened += float(np.sum(np.where(used, abs(off * batch.weights / scale) ** 2, 0.0)))
            plain += float(np.sum(abs(off[_used(batch)]) ** 2))
    return whitened, float(np.sqrt(plain))
