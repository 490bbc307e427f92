"""Effects in models: documents to objects and back."""

import dataclasses
import typing
from collections.abc import Sequence
from typing import Any

import numpy as np

from app.arrays import finite_list_or_none
from app.conversion.curves import curve_document
from app.conversion.models import kept_model
from app.conversion.varying_models import kept_varying
from app.schemas.effects import CurveDocument, EffectParameter, PlacedEffectDocument
from app.schemas.models import Model as ModelDocument
from app.schemas.plants import Plant
from identification.arrays import FloatArray
from identification.effects.library import library
from identification.effects.second_variable import SecondVariable
from identification.models.model import Model
from identification.models.state_space_model import carrying
from identification.places.place import Effect
from identification.places.placed import PlacedEffect


def effect_of(kind: str) -> Effect | None:
    """The effect of the library, or None when there is none of this kind."""
    return next((one for one in library() if one.kind == kind), None)


def chosen_effects(kinds: Sequence[str] | None, domain: str | None) -> tuple[Effect, ...]:
    """The effects of these kinds, or those of a domain and the general ones, or the whole library."""
    if kinds is None:
        return library(domain)
    return tuple(effect for kind in kinds if (effect := effect_of(kind)) is not None)


def extended_model(model: ModelDocument, plant: Plant) -> Model:
    """The model of a document with the effects that it carries; raises MisuseError where there is no such form."""
    covariance = None if model.joint_covariance is None else np.array(model.joint_covariance)
    effects = tuple(map(placed_effect, model.effects))
    if model.varying is not None:
        return carrying(kept_varying(model, plant), effects, covariance)
    return dataclasses.replace(kept_model(model, plant), effects=effects, joint_covariance=covariance)


def placed_effect(document: PlacedEffectDocument) -> PlacedEffect:
    """The effect of a document."""
    effect = effect_of(document.kind)
    assert effect is not None, "kept models carry effects of the library"
    hints = typing.get_type_hints(type(effect))
    values: dict[str, float | str] = {
        one.name: hints[one.name](round(one.value)) if hints[one.name] in (int, bool) else one.value
        for one in document.parameters
    }
    if document.quantity is not None:
        values["quantity"] = document.quantity
    if document.curve is not None:
        changed: Effect = dataclasses.replace(effect, **values, **_of_curve(document.curve))
        effect, values = changed, {}
    coefficients = np.array(document.coefficients, dtype=np.float64)
    return PlacedEffect(dataclasses.replace(effect, **values), coefficients, document.amplitude_degree)


def _of_curve(curve: CurveDocument) -> dict[str, Any]:
    """The fields of a law that its curve states."""
    return {"over": curve.over, "knots": tuple(curve.knots)}


def effect_documents(model: Model) -> list[PlacedEffectDocument]:
    """The documents of all effects in a model."""
    start, documents = model.plant_size, []
    for one in model.effects:
        stop = start + len(one.parameters())
        document = _document(one, _deviations(model.joint_covariance, slice(start, stop)))
        own = slice(start, start + one.size)
        known = None if model.joint_covariance is None else model.joint_covariance[own, own]
        curve = curve_document(model, one, known if known is not None and np.isfinite(known).all() else None)
        documents.append(document if curve is None else document.model_copy(update={"curve": curve}))
        start = stop
    return documents


def parameters_of(effect: Effect, deviations: Sequence[float] | None = None) -> list[EffectParameter]:
    """The parameters of an effect besides its amplitude; `deviations` of those that a refit adjusts."""
    names = effect.fitted_names()
    known = dict(zip(names, deviations, strict=True)) if deviations is not None else {}
    return [
        EffectParameter(
            name=field.name,
            value=float(getattr(effect, field.name)),
            standard_deviation=known.get(field.name),
            fitted=field.name in names,
        )
        for field in dataclasses.fields(effect)
        if isinstance(getattr(effect, field.name), int | float)
    ]


def quantity_of(effect: Effect) -> str | None:
    """The logged quantity that an effect depends on, or None."""
    return effect.quantity or None if isinstance(effect, SecondVariable) else None


def _deviations(covariance: FloatArray | None, part: slice) -> FloatArray | None:
    if covariance is None or not np.isfinite(covariance).all():
        return None
    return np.asarray(np.sqrt(np.maximum(np.diagonal(covariance)[part], 0.0)))


def _document(one: PlacedEffect, deviations: FloatArray | None) -> PlacedEffectDocument:
    known = deviations is not None
    found = np.full(len(one.parameters()), np.nan) if deviations is None else deviations
    amplitudes = found[: one.size].reshape(one.coefficients.shape)
    return PlacedEffectDocument(
        kind=one.effect.kind,
        title=one.effect.title,
        place=one.effect.place,
        unit=one.effect.unit,
        quantity=quantity_of(one.effect),
        amplitude_degree=one.degree,
        coefficients=one.coefficients.tolist(),
        standard_deviations=finite_list_or_none(amplitudes),
        parameters=parameters_of(one.effect, found[one.size :].tolist() if known else None),
    )
