"""Effects to documents and back: nothing of them is lost."""

import dataclasses

import numpy as np
import pytest

from app.conversion.effects import effect_documents, placed_effect
from app.schemas.effects import PlacedEffectDocument
from identification.effects.law import Law, Over
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


@pytest.mark.parametrize("over", ["displacement", "flow", "input", "output", "scheduling"])
def test_a_curve_is_kept_with_its_knots_and_drawn_with_its_band(over: Over) -> None:
    law = Law(over=over, knots=(-3.0, -1.0, 0.5, 1.5, 3.0), size=2.0, order=1, driven=True, coefficient=1)
    rng = np.random.default_rng(3)
    placed = PlacedEffect(law, rng.standard_normal((law.shapes, 1)))
    root = rng.standard_normal((BASE.plant_size + law.shapes,) * 2)
    covariance = root @ root.T
    model = dataclasses.replace(BASE, effects=(placed,), joint_covariance=covariance)
    (document,) = effect_documents(model)
    again = placed_effect(PlacedEffectDocument.model_validate_json(document.model_dump_json(by_alias=True)))
    assert again.effect == law
    np.testing.assert_array_equal(again.coefficients, placed.coefficients)
    assert document.curve is not None
    assert document.curve.standard_deviation is not None
    draws = rng.multivariate_normal(placed.coefficients[:, 0], covariance[BASE.plant_size :, BASE.plant_size :], 4000)
    i = len(document.curve.argument) // 3
    at = np.linspace(law.knots[int(law.on_signals)], law.knots[-1 - int(law.on_signals)], len(document.curve.argument))[
        i
    ]
    seen = np.array([law.curve(one).each(np.array([at]))[:, 0] @ one for one in draws])
    assert document.curve.value[i] == pytest.approx(seen.mean(), abs=5 * seen.std() / 60)
    assert document.curve.standard_deviation[i] == pytest.approx(seen.std(), rel=0.05)
