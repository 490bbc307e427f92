"""Every estimator from records with varying scheduling: documented, and one that finds the plant, told as it goes."""

import dataclasses
import inspect
from functools import cache
from typing import Any

import numpy as np
import pytest

import identification.varying
from benchmarks.affine_plant import AffinePlant
from identification.estimates import Estimate
from identification.models.state_space_model import stacks
from identification.registry import discover
from identification.varying.rates import variance_accounted_for
from identification.varying.records import VaryingRecord
from identification.varying.stacks import StackSizes
from tests.identification.varying.models import output_along, periodic_record, random_model

VARYING = discover(identification.varying)
named = pytest.mark.parametrize("plug_in", VARYING.values(), ids=lambda plug_in: plug_in.kind)


@cache
def plant() -> AffinePlant:
    model = random_model(np.random.default_rng(11))
    return dataclasses.replace(model, c=model.c * np.array([1.0, 0.0])[:, None, None])


@cache
def record() -> VaryingRecord:
    return periodic_record(plant(), np.random.default_rng(12), 120, 12, 20, noise=0.01)


def estimated(plug_in: Any, **options: Any) -> Estimate:
    """What the example finds, with a start where the estimator needs one."""
    needed = inspect.signature(plug_in.estimate).parameters.get("start")
    if needed is not None and needed.default is inspect.Parameter.empty:
        truth = plant()
        options["start"] = dataclasses.replace(truth, a=0.98 * truth.a, b=1.02 * truth.b).model()
    found: Estimate = plug_in.example().estimate(record(), 2, **options)
    return found


def test_what_is_there() -> None:
    assert set(VARYING) >= {"periodic_likelihood", "periodic_moesp", "correlation_realisation", "output_error"}


@named
def test_it_is_documented_and_frozen(plug_in: Any) -> None:
    assert plug_in.__doc__
    assert plug_in.example() == plug_in.example()
    hash(plug_in.example())
    for field in dataclasses.fields(plug_in):
        assert isinstance(getattr(plug_in.__annotations__[field.name], "__metadata__", ("",))[0], str), field.name
        assert plug_in.__annotations__[field.name].__metadata__[0], field.name
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(plug_in.example(), field.name, None)


@named
def test_it_finds_the_plant_the_same_every_time(plug_in: Any) -> None:
    told: list[tuple[float, str]] = []
    found = estimated(plug_in, progress=lambda fraction, message: told.append((fraction, message)))
    again = estimated(plug_in)
    assert np.array_equal(found.model.theta, again.model.theta)
    assert found.outcome.ok
    assert found.model.structure.sample_time == 1.0
    generator = np.random.default_rng(13)
    u, p = generator.standard_normal((500, 1)), generator.uniform(-1, 1, (500, 1))
    assert variance_accounted_for(plant().simulate(u, p), output_along(found.model, u, p)) > 99
    assert told
    assert all(0 <= fraction <= 1 and message for fraction, message in told)
    assert [fraction for fraction, _ in told] == sorted(fraction for fraction, _ in told)


@named
def test_a_covariance_has_the_rank_of_what_can_be_known(plug_in: Any) -> None:
    found = estimated(plug_in)
    covariance = found.model.covariance
    if covariance is None:
        return
    scale = np.sqrt(np.diag(covariance))
    values = np.linalg.eigvalsh(covariance / np.outer(scale, scale))
    assert np.allclose(covariance, covariance.T)
    assert values.min() > -1e-9
    assert int((values > 1e-9 * values.max()).sum()) == StackSizes.of(stacks(found.model)).free
