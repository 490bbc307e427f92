"""Curves of no stated form: what the splines are, and that every place simulates what its tangents say."""

import dataclasses

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.effects.law import Law
from identification.extension.fit import fit
from identification.extension.rows import Rows, effect_tangents
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.placed import PlacedEffect, placed
from identification.places.spline import spline, spread_knots
from identification.scheduling import ParameterDependence, ProductBasis
from tests.support.oscillators import DEPENDENCE, MODEL, batches

KNOTS = (-2.0, -0.7, 0.1, 0.4, 1.5, 3.0)
BATCHES = batches(11)
ROWS = Rows(BATCHES)
FLOW = MODEL.respond(BATCHES[0])
VARIANTS = Law().variants_over([FLOW])


def test_splines_are_smooth_and_equally_rough():
    """Two derivatives are continuous, straight beyond the ends, ∫ f″² dx = 1 over x in half distances."""
    shapes = spline(KNOTS)
    x = np.linspace(-4.0, 5.0, 90_001)
    step = x[1] - x[0]
    for one in shapes(x):
        bent = np.diff(one, 2) / step**2
        assert abs(np.diff(bent)).max() < 0.01 * abs(bent).max()
        assert abs(bent[x[1:-1] < -2.01]).max() < 1e-5
        assert abs(bent[x[1:-1] > 3.01]).max() < 1e-5
        half = 2.5
        assert np.sum(bent**2) * step * half**3 == pytest.approx(1.0, rel=1e-3)


def test_splines_hold_no_straight_line_at_their_knots_and_any_values_beyond_it():
    at = np.array(KNOTS)
    heights = spline(KNOTS)(at)
    straight = np.stack([np.ones(6), at])
    assert heights @ straight.T == pytest.approx(0.0, abs=1e-12)
    assert np.linalg.matrix_rank(np.concatenate([heights, straight])) == 6


def test_slopes_are_those_of_the_curve():
    c, x = np.array([0.3, -1.0, 0.5, 2.0]), np.linspace(-3, 4, 50)
    ends = [spline(KNOTS).combined(c, x + h) for h in (1e-6, -1e-6)]
    assert spline(KNOTS).combined(c, x, slope=True) == pytest.approx((ends[0] - ends[1]) / 2e-6, abs=1e-7)


def test_knots_follow_the_values_and_reach_beyond_their_ends():
    values = np.random.default_rng(0).standard_normal(5000)
    found = np.array(spread_knots(values, 10))
    assert found[0] < values.min()
    assert found[-1] > values.max()
    assert found[[1, -2]] == pytest.approx([values.min(), values.max()])
    assert np.diff(found)[5] < 0.8 * np.diff(found)[1]
    assert spread_knots(np.ones(30), 10) == ()


def test_the_places_are_every_motion_once_both_ends_and_the_coefficients():
    places = [(one.over, one.order) for one in VARIANTS if one.on_signals]
    assert places == [
        ("displacement", 0),
        ("flow", 0),
        ("displacement", 1),
        ("displacement", 2),
        ("input", 0),
        ("output", 0),
    ]
    assert [one.coefficient for one in VARIANTS if one.over == "scheduling"] == [0, 1, 2]


def places_of(law):
    return law.over, law.order, law.coefficient


def sensing(order):
    """The plant with its displacement, velocity or acceleration as the output."""
    bases = tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, *(0,) * (order + 1)))
    theta = np.array([1.5, 30.0, 10.0, 1.0, *np.zeros(order)])
    dependence = ParameterDependence(DEPENDENCE.variables, bases)
    return Model(RationalStructure(2, order), dependence, theta, np.eye(len(theta)), 1.0)


@pytest.mark.parametrize("law", VARIANTS, ids=lambda one: f"{one.over}-{one.order}-{one.coefficient}")
def test_each_shape_of_each_place_has_the_tangent_of_its_simulation(law):
    model = sensing(law.order)
    flow = model.respond(BATCHES[0])
    law = next(one for one in law.variants_over([flow]) if places_of(one) == places_of(law))
    one = placed(law, 0, 1)
    tangents = effect_tangents(one, ROWS, [flow])
    assert len(tangents) == law.shapes
    for i, tangent in enumerate(tangents):
        length = np.linalg.norm(tangent)
        if length < 1e-9 * np.linalg.norm(tangents):
            continue
        sides = []
        for sign in (1, -1):
            coefficients = np.zeros((law.shapes, 1))
            coefficients[i] = sign / length
            sides.append(model.plus(PlacedEffect(law, coefficients)).output(BATCHES[0]))
        change = ROWS.whiten([(sides[0] - sides[1])[None]])[0] * length / 2
        assert np.linalg.norm(change - tangent) < 2e-2 * length


def test_amplitudes_over_p_act_record_by_record():
    """A curve whose height grows with p is at each operating point the one of its amplitude there."""
    law = VARIANTS[0]
    g = np.random.default_rng(1)
    coefficients = 0.3 * g.standard_normal((law.shapes, 2))
    (batch,) = BATCHES
    found = MODEL.plus(PlacedEffect(law, coefficients, 1)).output(batch)
    points = MODEL.setting(batch.points).points[:, 0]
    for m, p in enumerate(points):
        own = PlacedEffect(law, coefficients[:, :1] + p * coefficients[:, 1:])
        assert found[m] == pytest.approx(MODEL.plus(own).output(batch)[m], rel=1e-6, abs=1e-9)


def test_a_narrow_prior_keeps_the_curve_at_nought_and_a_wide_one_does_not():
    law = VARIANTS[0]
    rough = placed(dataclasses.replace(law, size=1e3), 0, 1)
    narrow = placed(dataclasses.replace(law, size=1e-9), 0, 1)
    spoilt = dataclasses.replace(BATCHES[0], outputs=BATCHES[0].outputs * 1.05)
    sizes = [fit(MODEL.plus(one), Rows((spoilt,))).model.effects[0].coefficients[1:] for one in (rough, narrow)]
    assert abs(sizes[1]).max() < 1e-6
    assert abs(sizes[0]).max() > 1e-2
