"""The parametric estimators and pole regions keep the rules of plug-ins."""

import dataclasses
import itertools
import typing

import numpy as np
import pytest

import identification.parametric
import identification.pole_regions
from identification.errors import NotIdentifiableError
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.registry import discover
from tests.support.parametric import AFFINE, canonical_plant, responses

PARAMETRIC = discover(identification.parametric)
EVERY = [*PARAMETRIC.values(), *discover(identification.pole_regions).values()]
OMEGA = np.linspace(0.1, 6.0, 40)


def test_they_are_found():
    assert set(PARAMETRIC) == {"parametric_subspace", "state_space_likelihood"}


@pytest.mark.parametrize("plug_in", EVERY, ids=lambda plug_in: plug_in.kind)
def test_it_is_documented_frozen_and_has_an_example(plug_in):
    example = plug_in.example()
    assert example == plug_in.example()
    hash(example)
    hints = typing.get_type_hints(plug_in, include_extras=True)
    for field in dataclasses.fields(plug_in):
        assert isinstance(hints[field.name].__metadata__[0], str)
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(example, field.name, None)
    for name, member in vars(plug_in).items():
        if not name.startswith("_") and (callable(member) or isinstance(member, property)):
            assert member.__doc__, name


def test_examples_estimate_the_same_every_time():
    plant = canonical_plant(np.random.default_rng(0), (1,), 1, AFFINE, 0.5)
    data = responses(plant, [(0.0,), (0.5,), (1.0,)], OMEGA, np.random.default_rng(1), 0.01, variances=True)
    models = []
    for _ in range(2):
        start = PARAMETRIC["parametric_subspace"].example().estimate(AFFINE, data)
        refined = PARAMETRIC["state_space_likelihood"].example().estimate(start.model, data)
        assert start.outcome.ok
        assert start.errors[0].rms <= start.errors[0].maximum
        models.append((start.model, refined.model))
    for one, other in zip(*models, strict=True):
        assert np.array_equal(one.theta, other.theta)


@pytest.mark.parametrize("counts", [(2, 1), (1, 2), (3, 1)])
def test_the_chosen_rows_are_the_best_conditioned(counts):
    """Every other choice is worse, and what is reported is the worst over the operating points."""
    order = sum(counts)
    plant = canonical_plant(np.random.default_rng(1), counts, 1, AFFINE, 0.5)
    data = responses(plant, [(0.0,), (1.0,)], OMEGA)
    best = ParametricSubspace(order, order + 2).estimate(AFFINE, data).rows
    others = []
    for first in range(order + 1):
        method = ParametricSubspace(order, order + 2, rows_per_output=(first, order - first))
        try:
            others.append(method.estimate(AFFINE, data).rows.worst_singular_value)
        except NotIdentifiableError:
            others.append(0.0)
    assert len(set(others)) > 1
    assert best.worst_singular_value == max(others)
    assert len(best.indices) == len(set(best.indices)) == order
    assert all(a < b for a, b in itertools.pairwise(best.indices))
