"""What every effect would change, whitened, and cleared of what the fitted parameters can do."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.noise import noise_freedom, variance_of_projection
from identification.effects.misplaced_point import MisplacedPoint
from identification.extension.fit import Fit
from identification.extension.rows import effect_tangents
from identification.lti.whiteness import orthonormal
from identification.places.linear import Coefficient
from identification.places.nonlinear import Feedback
from identification.places.place import Effect
from identification.places.placed import PlacedEffect, placed
from identification.places.ports import EVERYWHERE, Port, ports

INVISIBLE = 1e-4
RECORDS = "it acts on signals, which only records of at least two periods show; these experiments are not all periodic"
TWICE = "the model has it already; several would only imitate a curve that is not in the library"
SHAPED = "the model has a curve of fitted shape in this place already, and two of them can imitate a third"
FEW_POINTS = "it needs {} operating points, and there are {}: with fewer a lower order fits them as well"
NOTHING = "nothing in this experiment to look at"
ALIKE = "the same as another effect of the library as long as it is not stated what the output is"
LOGGED = "no quantity was logged for every one of these experiments"


@dataclass(frozen=True, eq=False)
class Signature:
    """One variant of an effect: `basis` (c, R) orthonormal and orthogonal to the tangents of the fitted parameters.

    `gain` (c, c): basisᵀ(projected change) for amplitudes of one, so that e ≈ gain⁻¹ basis r; `kept`: the share of the
    length of the change that the projection leaves; `freedom`: real degrees of freedom of the noise variance that the
    signature meets; `variance` of basis r in noise alone.
    """

    placed: PlacedEffect
    basis: FloatArray
    gain: FloatArray
    kept: float
    freedom: float
    variance: float

    def amplitudes(self, residual: FloatArray) -> FloatArray:
        """The amplitude coefficients (c,) that the residual (R,) points to, to first order."""
        return np.asarray(np.linalg.lstsq(self.gain, self.basis @ residual, rcond=1e-12)[0])


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect with the variants that this experiment shows; `why_not` says so when it shows none.

    `judged`: False when it was not looked for, because of the data or of what the model holds already.
    """

    effect: Effect
    signatures: tuple[Signature, ...]
    looked_at: int = 1
    why_not: str = ""
    judged: bool = True
    port: Port = EVERYWHERE


def tangent_space(fit: Fit) -> FloatArray:
    """An orthonormal basis (k, R) of what the fitted parameters can change."""
    return np.ascontiguousarray(orthonormal(fit.tangents.T).T)


def candidates(fit: Fit, effects: Sequence[Effect], degree: int = 0) -> tuple[Candidate, ...]:
    """The effects with their signatures at the fit; amplitudes are polynomials of this degree in p.

    Effects on signals and misplaced points enter a model once, and only one whose shape is fitted at each place.
    """
    space, first = tangent_space(fit), _first_readings(effects, fit)
    places = ports(*fit.rows.batches[0].shape)
    found = []
    for effect in effects:
        there = _candidates(fit, effect, degree, space, first, places)
        found += there if any(one.signatures for one in there) else there[:1]
    return tuple(found)


def _candidates(
    fit: Fit,
    effect: Effect,
    degree: int,
    space: FloatArray,
    first: Mapping[tuple[str, int, bool], Feedback],
    places: Sequence[Port],
) -> list[Candidate]:
    """The effect in every place that it may act in: coefficients are those of all channels together."""
    if isinstance(effect, Coefficient):
        places = (EVERYWHERE,)
    return [replace(_candidate(fit, effect, degree, space, first, port), port=port) for port in places]


def _first_readings(effects: Sequence[Effect], fit: Fit) -> dict[tuple[str, int, bool], Feedback]:
    """Of forces that the signals cannot tell apart, as y may be a position or a speed, the one of lowest order."""
    forces = [effect for effect in effects if isinstance(effect, Feedback) and fit.flows]
    every = [one for effect in forces for one in effect.seen_by(fit.flows[0].batch)]
    return {one.seen_as: one for one in sorted(every, key=lambda one: -one.order)}


def _candidate(
    fit: Fit,
    effect: Effect,
    degree: int,
    space: FloatArray,
    first: Mapping[tuple[str, int, bool], Feedback],
    port: Port,
) -> Candidate:
    if not all(effect.judgeable(flow) for flow in fit.flows):
        return Candidate(
            effect, (), why_not=effect.unjudged or (RECORDS if effect.needs_records else LOGGED), judged=False
        )
    distinct = _distinct_points(fit)
    if distinct < effect.points_needed:
        return Candidate(effect, (), why_not=FEW_POINTS.format(effect.points_needed, distinct), judged=False)
    taken = _taken(effect, [one.effect for one in fit.model.effects])
    if taken:
        return Candidate(effect, (), why_not=taken, judged=False)
    variables = fit.flows[0].setting.points.shape[1]
    offered = effect.variants_over(fit.flows)
    variants = [placed(one, degree, variables, port=port) for one in offered if _is_first(one, first)]
    if not variants:
        return Candidate(effect, (), why_not=ALIKE if offered else NOTHING)
    changes = _changes(fit, variants)
    projected = changes - (changes @ space.T) @ space
    pieces = [slice(*ends) for ends in pairwise(np.cumsum([0, *(one.size for one in variants)]))]
    found = [_signature(fit, one, changes[p], projected[p]) for one, p in zip(variants, pieces, strict=True)]
    seen = tuple(one for one in found if one is not None)
    why = "" if seen else effect.unseen
    return Candidate(effect, seen, effect.looked_at(fit.flows[0]), why)


def _distinct_points(fit: Fit) -> int:
    """How many values the scheduling variable with most of them takes."""
    points = np.concatenate([flow.setting.points for flow in fit.flows])
    return max((len(np.unique(column)) for column in points.T), default=1)


def _is_first(one: Effect, first: Mapping[tuple[str, int, bool], Feedback]) -> bool:
    return not isinstance(one, Feedback) or type(first[one.seen_as]) is type(one)


def _taken(effect: Effect, there: Sequence[Effect]) -> str:
    if effect.kind in {one.kind for one in there if one.needs_records or isinstance(one, MisplacedPoint)}:
        return TWICE
    shaped = {_curve(one) for one in there if one.needs_records and one.fitted_names()}
    return SHAPED if effect.needs_records and effect.fitted_names() and _curve(effect) in shaped else ""


def _curve(effect: Effect) -> tuple[str, bool]:
    """Where it acts, and of forces whether on the displacement or the flow."""
    return effect.place, isinstance(effect, Feedback) and effect.on_displacement


def _changes(fit: Fit, variants: Sequence[PlacedEffect]) -> FloatArray:
    """The whitened changes by the amplitudes of all variants, (variants · c, R)."""
    every = [effect_tangents(one, fit.rows, fit.flows, further=False) for one in variants]
    return np.concatenate(every)


def signature_of(fit: Fit, one: PlacedEffect, space: FloatArray) -> Signature | None:
    """That of one variant at a fit, cleared of a space with an orthonormal basis (k, R); None where nothing is left."""
    changes = effect_tangents(one, fit.rows, fit.flows, further=False)
    return _signature(fit, one, changes, changes - (changes @ space.T) @ space)


def _signature(fit: Fit, one: PlacedEffect, changes: FloatArray, projected: FloatArray) -> Signature | None:
    before, after = np.linalg.norm(changes, axis=1), np.linalg.norm(projected, axis=1)
    if not np.all(np.isfinite(before)) or before.max() == 0 or after.max() <= INVISIBLE * before.max():
        return None
    several = len(projected) > 1
    basis = np.ascontiguousarray(orthonormal(projected.T).T) if several else projected / after[:, None]
    weight = np.sum(basis**2, axis=0) / len(basis)
    parts = fit.rows.parts(weight)
    freedom = noise_freedom(fit.rows.batches, parts)
    variance = variance_of_projection(fit.rows.batches, parts, freedom)
    return Signature(one, basis, basis @ projected.T, float(after.max() / before.max()), freedom, variance)
