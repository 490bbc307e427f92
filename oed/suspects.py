"""Effects of the library as a target names them, and models that imitate each other."""

import dataclasses
from collections.abc import Sequence

import numpy as np

from identification.comparison.batch import Batch
from identification.diagnosis.signatures import Signature, candidates
from identification.effects.library import library
from identification.errors import RangeError
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.places.place import Effect
from identification.places.placed import placed

SHARP = 1e-3
NOTHING = 1e-6
MOTION = ("order", "driven")


def known(kind: str, field: str) -> Effect:
    """The example of an effect of the library; raises RangeError when there is none of this kind."""
    effect = next((one for one in library() if one.kind == kind), None)
    if effect is None:
        raise RangeError(f"there is no effect {kind}; the catalogue names those that there are", field)
    return effect


def named(kind: str, parameters: Sequence[float]) -> Effect:
    """The effect of the library with its further parameters, in the order in which a diagnosis lists them.

    Those that say how a force meets the motion (`MOTION`) may be left out: it then acts on the output itself, taken as
    a displacement. Raises RangeError when there is none of this kind, or the parameters are not its own.
    """
    effect = known(kind, "effect")
    every = [one.name for one in dataclasses.fields(effect) if isinstance(getattr(effect, one.name), int | float)]
    shape = [name for name in every if name not in MOTION]
    own = shape if len(parameters) == len(shape) else every
    if len(parameters) != len(own):
        which = f" ({', '.join(own)})" if own else ""
        raise RangeError(f"{kind} has {len(own)} further parameters{which}, {len(parameters)} were given", "parameters")
    types = [type(getattr(effect, name)) for name in own]
    values = {name: make(value) for name, make, value in zip(own, types, parameters, strict=True)}
    return dataclasses.replace(effect, **values)


def with_effect(model: Model, effect: Effect, amplitude: float | None, measured: Sequence[Batch]) -> Model:
    """The model with the effect at an amplitude, or with what fits the measurements best where none is stated."""
    if amplitude is not None:
        return model.plus(placed(effect, 0, 1, amplitude))
    found = grown(model, (effect,), measured)
    if found is None:
        raise RangeError(f"the earlier experiments do not show {effect.title}; state its amplitude", "amplitude")
    return found.model


def imitation(model: Model, kind: str, truth: Model, reference: Sequence[Batch]) -> Model:
    """The model with an effect of this kind, fitted to what the truth would give in the reference experiments."""
    batches = [dataclasses.replace(batch, outputs=truth.output(batch)) for batch in reference]
    effect = known(kind, "against")
    found = grown(model, (effect,), batches, SHARP * _norm(model, batches))
    if found is None:
        raise RangeError(f"{effect.title} is invisible in these experiments; it need not be told apart", "against")
    return found.model


def acts(model: Model, reference: Sequence[Batch]) -> bool:
    """Whether the last effect of a model changes its outputs; it was not fitted away."""
    without = dataclasses.replace(model, effects=model.effects[:-1])
    return any(
        np.linalg.norm(model.output(batch) - without.output(batch)) > NOTHING * np.linalg.norm(without.output(batch))
        for batch in reference
    )


def grown(model: Model, variants: Sequence[Effect], batches: Sequence[Batch], unit: float = 1.0) -> Fit | None:
    """θ and the best variant of the effects fitted together, residuals in this unit; None when none of them shows."""
    base = fit(model, Rows(tuple(batches), (unit,) * len(batches)))
    seen = [one for candidate in candidates(base, variants) for one in candidate.signatures]
    if not seen:
        return None
    best = max(seen, key=lambda one: _explained(one, base))
    effect = best.placed.effect
    amplitudes = best.amplitudes(base.residual)
    if effect.sign and amplitudes.size == 1:
        amplitudes = effect.sign * abs(amplitudes)
    start = dataclasses.replace(best.placed, coefficients=amplitudes.reshape(best.placed.coefficients.shape))
    return fit(base.model.plus(start), base.rows, tolerance=1e-6)


def _norm(model: Model, batches: Sequence[Batch]) -> float:
    rows = Rows(tuple(batches))
    return float(np.linalg.norm(rows.residual([model.respond(batch) for batch in batches])))


def _explained(one: Signature, base: Fit) -> float:
    return float(np.sum((one.basis @ base.residual) ** 2))
