"""Effects to documents and back: nothing of them is lost."""

import dataclasses

import numpy as np
import pytest

from app.conversion.effects import effect_documents, placed_effect
from app.schemas.effects import PlacedEffectDocument
from identification.effects.library import library
from identification.models.model import Model
from identification.places.place import Effect
from identification.places.placed import PlacedEffect
from tests.support.plants import DEPENDENCE, EXAMPLE, THETA

BASE = Model(EXAMPLE, DEPENDENCE, THETA, np.eye(6), 1.0)


def changed(effect: Effect) -> Effect:
    """The effect with other parameters than those it has by default."""
    kinds = {field.name: type(getattr(effect, field.name)) for field in dataclasses.fields(effect)}
    values = {name: 1 if kind is int else 0.375 for name, kind in kinds.items() if kind in (int, float)}
    return dataclasses.replace(effect, **values)


@pytest.mark.parametrize("effect", library(), ids=lambda effect: effect.kind)
@pytest.mark.parametrize("degree", [0, 2])
def test_a_document_becomes_the_same_effect(effect: Effect, degree: int) -> None:
    coefficients = np.arange(1.0, 1.0 + effect.shapes * (1 + degree)).reshape(effect.shapes, -1)
    placed = PlacedEffect(changed(effect), coefficients, degree)
    document = effect_documents(dataclasses.replace(BASE, effects=(placed,)))[0]
    again = placed_effect(PlacedEffectDocument.model_validate_json(document.model_dump_json(by_alias=True)))
    assert again.effect == placed.effect
    assert [type(value) for value in dataclasses.astuple(again.effect)] == [
        type(value) for value in dataclasses.astuple(placed.effect)
    ]
    np.testing.assert_array_equal(again.coefficients, coefficients)
    assert again.degree == degree
    assert document.standard_deviations is None


def test_deviations_are_those_of_the_effect_and_not_of_its_neighbours() -> None:
    resonance = next(one for one in library() if one.kind == "resonance")
    delay = next(one for one in library() if one.kind == "delay")
    placed = [PlacedEffect(resonance, np.array([[0.5]])), PlacedEffect(delay, np.array([[0.1]]))]
    further = len(resonance.fitted_names())
    size = BASE.plant_size + 1 + further + 1
    covariance = np.diag(np.arange(1.0, size + 1) ** 2)
    first, second = effect_documents(dataclasses.replace(BASE, effects=tuple(placed), joint_covariance=covariance))
    k = BASE.plant_size
    assert first.standard_deviations == [[k + 1.0]]
    fitted = [one.standard_deviation for one in first.parameters if one.fitted]
    assert fitted == [k + 2.0 + i for i in range(further)]
    assert second.standard_deviations == [[float(size)]]
