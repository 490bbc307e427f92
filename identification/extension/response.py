"""The frequency response of a model with effects, as far as it has one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import EXCITED, Batch
from identification.extension.rows import Rows, effect_tangents, plant_tangents
from identification.models.model import Model
from identification.models.phase import continuous_phase
from identification.places.core import Reshaped
from identification.places.linear import Coefficient, Factor, Parallel
from identification.places.place import Effect
from identification.places.placed import PlacedEffect

LINEAR = (Coefficient, Factor, Parallel, Reshaped)


@dataclass(frozen=True, eq=False)
class LinearResponse:
    """G (M, F) with the covariance (M, F, 2, 2) of its real and imaginary part, None where that is not known.

    `left_out`: effects that G does not hold, as they act on signals or belong to the measurements, not to the plant.
    """

    response: ComplexArray
    covariance: FloatArray | None
    left_out: tuple[Effect, ...]


def linear_response(
    model: Model, points: ArrayLike, omega: FloatArray, channel: tuple[int, int] = (0, 0)
) -> LinearResponse:
    """G(p, ω) at points (M, s) and ω (F,): exact with effects that act linearly, else that of the linear core.

    `channel`: output and input, counted from 0.

    The covariance is J P Jᵀ, to first order in the joint covariance P of all parameters; without effects P_θ.
    """
    held = [_acts_linearly(one.effect) for one in model.effects]
    left_out = tuple(one.effect for one, kept in zip(model.effects, held, strict=True) if not kept)
    kept = with_only(replace(model, joint_covariance=model.known_covariance), held)
    batch = _unit_input(model, points, omega, channel)
    with np.errstate(divide="ignore", invalid="ignore"):
        flow = kept.respond(batch)
        known = kept.joint_covariance
        covariance = None if known is None else _covariance(kept, known, batch)
    return LinearResponse(flow.output, covariance, left_out)


def response_phase(model: Model, point: Sequence[float] | FloatArray, omega: FloatArray) -> FloatArray:
    """arg G(p, ω) (F,) in rad of that response at one point (s,), its delays in full; see `continuous_phase`."""
    batch = _unit_input(model, np.array([point], dtype=np.float64), np.ones(1))
    kept = with_only(model, [_acts_linearly(one.effect) for one in model.effects])
    setting = kept.setting(batch.points, batch.ports)
    late = model.structure.dead_time(setting.zeta)[0] + sum(
        one.effect.dead_time(one.amplitude(setting, batch))[0] for one in kept.effects
    )

    def response(w: FloatArray) -> ComplexArray:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(kept.respond(_unit_input(kept, batch.points, w)).output[0])

    return continuous_phase(response, omega, float(late), model.structure.memory)


def coefficients(model: Model, points: ArrayLike) -> FloatArray:
    """ζ(p) at the points (M, s) with what effects change of it, (M, n)."""
    changing = [isinstance(_in_place(one.effect), Coefficient) and _acts_linearly(one.effect) for one in model.effects]
    batch = _unit_input(model, points, np.ones(1))
    return with_only(model, changing).respond(batch).setting.zeta


def _acts_linearly(effect: Effect) -> bool:
    return isinstance(_in_place(effect), LINEAR) and not effect.of_measurements


def _in_place(effect: Effect) -> Effect:
    return effect.composed(np.zeros((effect.shapes, 1)))[0]


def with_only(model: Model, held: list[bool]) -> Model:
    """The model with some of its effects, and their part of the joint covariance."""
    chosen = [np.ones(model.plant_size, dtype=np.bool_)]
    chosen += [np.full(len(one.parameters()), kept) for one, kept in zip(model.effects, held, strict=True)]
    part = np.flatnonzero(np.concatenate(chosen))
    covariance = None if model.joint_covariance is None else model.joint_covariance[np.ix_(part, part)]
    effects = tuple(one for one, kept in zip(model.effects, held, strict=True) if kept)
    return replace(model, effects=effects, joint_covariance=covariance)


def _unit_input(model: Model, at: ArrayLike, omega: FloatArray, channel: tuple[int, int] = (0, 0)) -> Batch:
    """What would be measured with U = 1, weighted such that whitened rows are real and imaginary parts."""
    points, plant = model.dependence.points(at), (model.structure.outputs, model.structure.inputs)
    shape = (len(points), len(omega))
    return Batch(
        points=points,
        omega=omega,
        inputs=np.ones(shape, dtype=np.complex128),
        outputs=np.zeros(shape, dtype=np.complex128),
        variances=np.full(shape, 2.0),
        classes=np.full(shape, EXCITED),
        members=np.arange(len(points)),
        ports=None if plant == (1, 1) else np.tile(np.array(channel), (len(points), 1)),
        shape=plant,
    )


def _covariance(model: Model, known: FloatArray, batch: Batch) -> FloatArray:
    rows, flows = Rows((batch,)), (model.respond(batch),)
    tangents = [plant_tangents(model, rows, flows)]
    tangents += [effect_tangents(one, rows, flows) / _scale(one)[:, None] for one in model.effects]
    parts = np.concatenate(tangents).reshape(-1, len(batch.points), 2, len(batch.omega))
    return np.asarray(np.einsum("kmif,kl,lmjf->mfij", parts, known, parts, optimize=True))


def _scale(one: PlacedEffect) -> FloatArray:
    """What turns derivatives by the logarithm of further parameters into those by the parameters."""
    return np.concatenate([np.ones(one.size), one.effect.values()])
