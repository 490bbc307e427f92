"""Where to begin with effects that may be large: a coarse scan of whole responses, then a few steps from the best."""

import numpy as np

from identification.arrays import FloatArray
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows, effect_tangents, plant_tangents
from identification.models.model import Model
from identification.places.place import Effect
from identification.places.placed import PlacedEffect, placed

LARGE = 0.1
TRIED, CARRIED_ON, FEW_STEPS = 12, 3, 4


def misfit_is_large(base: Fit) -> bool:
    """Whether more than a tenth of what was measured is not explained, in the measure of the noise."""
    parts = zip(base.rows.batches, base.rows.scales, strict=True)
    measured = sum(float(batch.measured @ batch.measured) / scale**2 for batch, scale in parts)
    return bool(base.residual @ base.residual > LARGE**2 * measured)


def scanned_starts(base: Fit, origin: Model, like: PlacedEffect) -> list[Model]:
    """Models with the effect, from which its refit may begin: the best of its scan after a few steps.

    The scan is made around the model as it was given and around its refit `base` without the effect: where much is
    missing the refit has bent its parameters to make up for it, and leads nowhere. Of amplitudes that fit alike, such
    as delays that differ by a period, the smallest is kept.
    """
    tried: list[tuple[float, float, Model]] = []
    for model in (origin, base.model):
        flows = tuple(model.respond(batch) for batch in base.rows.batches)
        variables = flows[0].setting.points.shape[1]
        for one, amplitude in like.effect.scan(flows):
            trial = model.plus(placed(one, like.degree, variables, amplitude, like.port))
            tried.append((_after_a_step(trial, base.rows), abs(amplitude), trial))
    few = [model for cost, model in _smallest_of_alike(tried)[:TRIED] if np.isfinite(cost)]
    begun = [fit(model, base.rows, iterations=FEW_STEPS, tolerance=0.05) for model in few]
    best = sorted(begun, key=lambda one: one.cost)[:CARRIED_ON]
    return [one.model for one in best]


def _smallest_of_alike(tried: list[tuple[float, float, Model]]) -> list[tuple[float, Model]]:
    """(cost, model) by cost, one of each cost."""
    kept: dict[str, tuple[float, Model]] = {}
    for cost, _, model in sorted(tried, key=lambda one: one[1]):
        kept.setdefault(f"{cost:.6e}", (cost, model))
    return sorted(kept.values(), key=lambda one: one[0])


def _after_a_step(model: Model, rows: Rows) -> float:
    """What a linear step in θ and the amplitude would leave of ‖r‖²."""
    flows = tuple(model.respond(batch) for batch in rows.batches)
    last: PlacedEffect = model.effects[-1]
    tangents = np.concatenate([plant_tangents(model, rows, flows), effect_tangents(last, rows, flows, further=False)])
    residual = rows.residual(flows)
    if not np.all(np.isfinite(residual)) or not np.all(np.isfinite(tangents)):
        return float("inf")
    return float(residual @ residual) - _explained(tangents, residual)


def _explained(tangents: FloatArray, residual: FloatArray) -> float:
    size = np.linalg.norm(tangents, axis=1)
    kept = tangents[size > 0] / size[size > 0, None]
    values, vectors = np.linalg.eigh(kept @ kept.T)
    used = values > 1e-9 * values[-1]
    return float(np.sum((vectors[:, used].T @ (kept @ residual)) ** 2 / values[used]))


def states_scan(effect: Effect) -> bool:
    """Whether an effect may be large."""
    return type(effect).scan is not Effect.scan
