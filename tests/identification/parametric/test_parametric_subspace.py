"""Parametric subspace models: exact without noise, their poles where they were asked to be, misuse named."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from identification.errors import MisuseError, NotIdentifiableError, RangeError, ShapeError, TooFewOperatingPointsError
from identification.models.state_space_model import stacks
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.pole_regions.cone import Cone
from identification.pole_regions.disc import Disc
from identification.pole_regions.half_plane import HalfPlane
from identification.pole_regions.intersection import Intersection
from identification.pole_regions.strip import Strip
from identification.scheduling import SchedulingVariable
from identification.signals import FrequencyResponse
from tests.support.parametric import (
    AFFINE,
    LINES,
    canonical_plant,
    dependence,
    example_data,
    example_response,
    responses,
    worst_relative_error,
)

EVERYWHERE = np.linspace(0, 1, 11)[:, None]
TWO = (SchedulingVariable("p", "", 0.0, 1.0), SchedulingVariable("r", "bar", -2.0, 3.0))


def random_points(variables, count, seed=0):
    g = np.random.default_rng(seed)
    return np.column_stack([g.uniform(v.minimum, v.maximum, count) for v in variables])


@pytest.mark.parametrize("weighting", ["none", "variance"])
@pytest.mark.parametrize(("region", "accuracy"), [(None, 1e-11), (Disc(), 1e-7)])
def test_the_example_of_the_paper_comes_back(weighting, region, accuracy):
    found = ParametricSubspace(2, 10, weighting, region=region).estimate(AFFINE, example_data())
    assert found.outcome.ok
    for p in EVERYWHERE[:, 0]:
        truth = example_response(p)
        response = found.model.frequency_response([[p]], LINES)[0, :, 0, 0]
        assert abs(response - truth).max() < accuracy * abs(truth).max()
        assert np.allclose(
            np.poly(found.model.structure.matrices(found.model.coefficients([[p]]))[0][0]),
            [1, 0.01 * p, 0.99],
            atol=accuracy,
        )
    assert max(error.relative for error in found.errors) < accuracy


@given(
    st.integers(0, 10_000),
    st.sampled_from([(1,), (2,), (5,), (2, 1), (2, 2), (3, 2)]),
    st.integers(1, 3),
    st.sampled_from([0.5, None]),
    st.sampled_from([(1, 1, 1, 1), (2, 1, 0, 2), (1, 0, 1, 0), (0, 2, 0, 1)]),
)
@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
def test_it_is_exact_with_the_fewest_lines(seed, counts, inputs, sample_time, degrees):
    """Theorem 3 of McKelvey at every operating point: q + n lines are enough, wherever they lie."""
    g = np.random.default_rng(seed)
    depends = dependence(*degrees)
    plant = canonical_plant(g, counts, inputs, depends, sample_time)
    order = sum(counts)
    q = order + 2
    omega = np.sort(g.uniform(0.1, 6.0, q + order)) + 1e-3 * np.arange(q + order)
    points = [(p,) for p in np.linspace(0, 1, max(degrees) + 1)]
    method = ParametricSubspace(order, q, rows_per_output=counts)
    found = method.estimate(depends, responses(plant, points, omega))
    assert found.rows.counts == counts
    assert worst_relative_error(found.model, plant, EVERYWHERE, np.linspace(0.1, 6, 50)) < 1e-6


def test_two_scheduling_variables_and_constant_b_and_d():
    g = np.random.default_rng(3)
    depends = dependence(1, 0, 1, 0, variables=TWO)
    plant = canonical_plant(g, (2, 1), 2, depends, 0.5)
    points = [(0.0, -2.0), (1.0, -2.0), (0.0, 3.0), (1.0, 3.0)]
    data = responses(plant, points, np.linspace(0.1, 6, 40))
    found = ParametricSubspace(3, 8, rows_per_output=(2, 1), region=Disc()).estimate(depends, data)
    assert found.outcome.ok
    assert found.region.where == "whole range"
    assert found.region.points == 4
    assert [len(part) for part in stacks(found.model)][1::2] == [1, 1]
    assert worst_relative_error(found.model, plant, random_points(TWO, 20), np.linspace(0.1, 6, 50)) < 1e-6


REGIONS = [
    (Disc(), 0.5),
    (Disc(0.95, 0.0), 0.5),
    (Intersection((Disc(), HalfPlane(-0.7, "right"), Strip(0.8))), 0.5),
    (HalfPlane(-0.2), None),
    (Intersection((Cone(1.2), HalfPlane(-0.1), HalfPlane(-6.0, "right"))), None),
]


@given(st.integers(0, 10_000), st.sampled_from(REGIONS), st.booleans(), st.sampled_from(["frobenius", "spectral"]))
@settings(max_examples=25, deadline=None)
def test_poles_lie_in_the_region_everywhere_in_the_range(seed, asked, two, misfit):
    region, sample_time = asked
    g = np.random.default_rng(seed)
    variables = TWO if two else TWO[:1]
    depends = dependence(1, 1, 1, 1, variables=variables)
    plant = canonical_plant(g, (3,), 1, depends, sample_time)
    points = random_points(variables, 5, seed)
    data = responses(plant, points, np.linspace(0.1, 6, 60), g, level=0.3)
    method = ParametricSubspace(3, 8, region=region, margin=1e-4, misfit=misfit)
    found = method.estimate(depends, data)
    assert found.region.where == "whole range"
    assert found.region.certificate < 0
    excess = region.excess(found.model.poles(random_points(variables, 1000, seed + 1)))
    assert excess.max() < -0.5e-4


def test_noise_makes_the_free_model_unstable_and_never_the_constrained_one():
    everywhere = np.linspace(0, 1, 1001)[:, None]
    unstable = 0
    for seed in range(12):
        data = example_data(np.random.default_rng(seed))
        free = ParametricSubspace(2, 10, "none").estimate(AFFINE, data)
        kept = ParametricSubspace(2, 10, "none", region=Disc()).estimate(AFFINE, data)
        unstable += not free.model.stable(everywhere).all()
        assert bool(free.outcome.advice) == (not free.model.stable(everywhere).all())
        assert kept.outcome.ok
        assert kept.model.stable(everywhere).all()
        assert kept.region.error < 1.2 * kept.region.error_without
    assert 3 <= unstable <= 10


def test_a_polynomial_dependence_is_constrained_on_a_grid_and_says_so():
    depends = dependence(2, 1, 0, 1)
    data = example_data(np.random.default_rng(1), points=(0.0, 0.5, 1.0))
    found = ParametricSubspace(2, 10, region=Disc()).estimate(depends, data)
    assert found.region.where == "grid"
    assert found.region.points == 17
    assert "nothing is proved" in found.outcome.advice
    assert Disc().contains(found.model.poles(EVERYWHERE)).all()


def test_a_region_that_the_data_contradict_is_an_outcome_with_numbers():
    found = ParametricSubspace(2, 10, region=Disc(0.9)).estimate(AFFINE, example_data())
    assert found.outcome.status == "infeasible"
    assert "leave the region by up to 0.095" in found.outcome.advice
    assert found.region.worst_excess < 0
    assert found.region.worst_excess_without == pytest.approx(np.sqrt(0.99) - 0.9, abs=1e-6)


def test_known_variances_that_differ_by_operating_point_help():
    g = np.random.default_rng(5)
    depends = AFFINE
    plant = canonical_plant(g, (3,), 1, depends, 0.5)
    omega = np.linspace(0.02, 6.2, 300)
    errors = {"variance": [], "none": []}
    for _ in range(20):
        data = []
        for m, p in enumerate((0.0, 0.5, 1.0)):
            clean = plant.frequency_response([(p,)], omega)[0]
            sigma = np.where((omega > 2 * m) & (omega < 2 * m + 2), 0.5, 0.005)[:, None, None] * np.ones(clean.shape)
            noise = g.standard_normal((*clean.shape, 2)) @ [1, 1j] * sigma
            data.append(FrequencyResponse(omega, clean + noise, (p,), 0.5, 2 * sigma**2))
        for weighting, found in errors.items():
            model = ParametricSubspace(3, 10, weighting).estimate(depends, data).model
            found.append(worst_relative_error(model, plant, EVERYWHERE, omega))
    assert np.median(errors["variance"]) < 0.3 * np.median(errors["none"])


def test_the_unit_of_the_scheduling_variable_does_not_matter():
    far = (SchedulingVariable("x", "m", 15_000.0, 16_000.0),)
    data = example_data(np.random.default_rng(2), points=(0.0, 0.4, 1.0))
    moved = [
        FrequencyResponse(d.frequencies, d.response, (15_000 + 1000 * d.operating_point[0],), d.sample_time)
        for d in data
    ]
    method = ParametricSubspace(2, 10, region=Disc())
    one, other = (
        method.estimate(depends, responses)
        for depends, responses in ((AFFINE, data), (dependence(1, 1, 1, 1, variables=far), moved))
    )
    difference = one.model.frequency_response([[0.7]], LINES) - other.model.frequency_response([[15_700.0]], LINES)
    assert abs(difference).max() < 1e-4 * abs(example_response(0.7)).max()


def few_lines(count):
    return [FrequencyResponse(LINES[:count], d.response[:count], d.operating_point, 1e-3) for d in example_data()]


@pytest.mark.parametrize(
    ("make", "error", "field", "words"),
    [
        (lambda: ParametricSubspace(0), RangeError, "order", "one or more"),
        (lambda: ParametricSubspace(4, 4), RangeError, "block_rows", "above the order"),
        (lambda: ParametricSubspace(2, region=Disc(), margin=0.0), RangeError, "margin", "positive"),
        (lambda: ParametricSubspace(2, region=Disc(0.1), margin=0.2), RangeError, "margin", "0.1 too little"),
        (lambda: ParametricSubspace(2, region=Disc(), grid_count=1), RangeError, "grid_count", "two or more"),
        (lambda: ParametricSubspace(2, 10).estimate(AFFINE, []), ShapeError, "experiments", "no frequency"),
        (
            lambda: ParametricSubspace(2, 10).estimate(AFFINE, few_lines(11)),
            NotIdentifiableError,
            "frequencies",
            "measure 12 lines or more",
        ),
        (
            lambda: ParametricSubspace(2, 10).estimate(AFFINE, example_data(points=(0.5,))),
            TooFewOperatingPointsError,
            "operating_points",
            "at least 2",
        ),
        (
            lambda: ParametricSubspace(2, 10).estimate(dependence(1, 1), example_data()),
            ShapeError,
            "dependence",
            "A, B, C and D",
        ),
        (
            lambda: ParametricSubspace(2, 10, rows_per_output=(1, 1)).estimate(AFFINE, example_data()),
            ShapeError,
            "rows_per_output",
            "one count per output",
        ),
    ],
)
def test_misuse_is_named(make, error, field, words):
    with pytest.raises(error, match=words) as caught:
        make()
    assert caught.value.field == field


def test_data_that_do_not_fit_together_are_refused():
    one = example_data()
    matrix = FrequencyResponse(LINES, np.ones((400, 1, 2)) + 0j, (0.3,), 1e-3)
    slow = FrequencyResponse(LINES / 10, one[0].response, (0.3,), 1e-2)
    with pytest.raises(ShapeError, match="same channels"):
        ParametricSubspace(2, 10).estimate(AFFINE, [*one, matrix])
    with pytest.raises(MisuseError, match="one for all"):
        ParametricSubspace(2, 10).estimate(AFFINE, [*one, slow])
