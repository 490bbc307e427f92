"""Every effect of the library: says what it is, does nothing at zero, and its tangent is that of its simulation."""

import dataclasses
import re

import numpy as np
import pytest

from identification.effects.delay import Delay
from identification.effects.library import library
from identification.effects.rate_dependence import RateDependence
from identification.effects.rc_arc import RcArc
from identification.effects.resonance import Resonance
from identification.effects.second_variable import SecondVariable
from identification.extension.fit import differences, fit
from identification.extension.rows import Rows, effect_tangents
from identification.places.nonlinear import Feedback
from identification.places.placed import placed
from tests.support.oscillators import MODEL, batches

BATCHES = batches(11)
ROWS = Rows(BATCHES)
FLOW = MODEL.respond(BATCHES[0])
LOGGED = (1.0, -1.0, 2.0, 0.5, 3.0)
OF_MEASUREMENTS = {"second_variable": SecondVariable(LOGGED, 1), "rate_dependence": RateDependence(LOGGED, 1)}
EFFECTS = [OF_MEASUREMENTS.get(effect.kind, effect) for effect in library()]
each = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.kind)


def instance(effect):
    """A variant in the middle of the scan, so that thresholds lie inside the signals; the output is a displacement."""
    variants = [one for one in effect.variants(FLOW) if not isinstance(one, Feedback) or one.order == 0]
    return variants[len(variants) // 2] if variants else effect


def test_the_library_is_as_large_as_promised_and_has_every_place():
    assert len(EFFECTS) >= 40
    assert {effect.place for effect in EFFECTS} >= {
        "scheduled coefficient",
        "multiplies the linear response",
        "added to the linear response",
        "actuator",
        "feedback from output or velocity",
        "sensor",
        "added to the output",
        "recorder",
    }


def test_a_domain_leaves_the_others_out():
    kinds = {effect.kind for effect in library("mechanical")}
    assert "coulomb_friction" in kinds
    assert "delay" in kinds
    assert "warburg" not in kinds


@each
def test_it_says_what_it_is(effect):
    assert effect.title
    assert effect.unit
    assert re.fullmatch(r"\[[A-Z]\w+\d{4}, .+\]", effect.source)
    assert effect.__doc__
    assert dataclasses.is_dataclass(effect)
    assert effect.with_values(effect.values()) == effect


@each
def test_it_does_nothing_at_zero(effect):
    (batch,) = BATCHES
    with_it = MODEL.plus(placed(instance(effect), 0, 1)).output(batch)
    assert np.allclose(with_it, FLOW.output, rtol=1e-9, atol=1e-13)


@each
def test_its_tangent_is_that_of_its_simulation(effect):
    """Differences of the simulation on both sides of zero; catches a sign, a factor, a place."""
    one = placed(instance(effect), 0, 1)
    tangent = effect_tangents(one, ROWS, [FLOW])[0]
    assert np.all(np.isfinite(tangent))
    length = np.linalg.norm(tangent)
    if length == 0:
        pytest.skip("nothing to see in this experiment")
    step = 1.0 / length
    sides = []
    for sign in (1, -1):
        coefficients = one.coefficients.copy()
        coefficients[0, 0] = sign * step
        sides.append(MODEL.plus(dataclasses.replace(one, coefficients=coefficients)).output(BATCHES[0]))
    change = ROWS.whiten([(sides[0] - sides[1])[None]])[0] / (2 * step)
    assert np.linalg.norm(change - tangent) < 2e-2 * length


def test_tangents_of_filters_and_modes_in_one_model_are_those_of_their_simulation():
    """A delay moves the mode as well, but not the path beside the plant."""
    model = MODEL.plus(placed(Resonance(9.0, 0.05), 0, 1, 2.0)).plus(placed(RcArc(0.4), 0, 1, 0.02))
    found = fit(model.plus(placed(Delay(), 0, 1, 0.03)), ROWS, iterations=0)
    exact = differences(found)
    for row, column in zip(found.tangents, exact, strict=True):
        assert np.linalg.norm(row - column) < 2e-2 * np.linalg.norm(column)


@pytest.mark.parametrize("effect", [e for e in EFFECTS if e.fitted_names()], ids=lambda effect: effect.kind)
def test_further_parameters_have_their_tangents(effect):
    one = placed(instance(effect), 0, 1)
    length = np.linalg.norm(effect_tangents(one, ROWS, [FLOW])[0])
    model = MODEL.plus(placed(one.effect, 0, 1, 15.0 / length))
    found = fit(model, ROWS, iterations=0)
    exact = differences(found)
    for row in range(-len(effect.fitted_names()), 0):
        size = np.linalg.norm(exact[row])
        assert np.linalg.norm(exact[row] - found.tangents[row]) < 0.15 * size + 1e-3
