"""Every plug-in of identification: documented, with an example that works, the same every time."""

import dataclasses

import numpy as np
import pytest

import identification.bases
import identification.lpv
import identification.lti
import identification.spectral
import identification.subspace
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError
from identification.models.model import LocalModel, Model
from identification.models.rational import RationalStructure
from identification.registry import discover
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate
from identification.subspace.result import SubspaceEstimate
from tests.support.state_space import noisy, random_system, relative_error

BASES = discover(identification.bases)
SPECTRAL = discover(identification.spectral)
LTI = discover(identification.lti)
LPV = discover(identification.lpv)
SUBSPACE = discover(identification.subspace)
EVERY = [*BASES.values(), *SPECTRAL.values(), *LTI.values(), *LPV.values(), *SUBSPACE.values()]

PLANT = RationalStructure(n_a=1, n_b=0, n_k=1, sample_time=0.5)
DEPENDENCE = ParameterDependence(
    (SchedulingVariable("p", "V", 0.0, 1.0),), tuple(ProductBasis((Polynomial(1),)) for _ in range(2))
)
THETA = np.array([-0.8, 0.3, 1.0, 0.5])
PERIOD, PERIODS = 128, 8
POINTS = (0.0, 0.5, 1.0)


def named(plug_ins):
    return pytest.mark.parametrize("plug_in", plug_ins, ids=lambda plug_in: plug_in.kind)


def record_at(p):
    g = np.random.default_rng(int(100 * p))
    u = np.tile(g.choice([-1.0, 1.0], PERIOD), PERIODS)
    zeta = (DEPENDENCE.matrix([[p]]) @ THETA)[0]
    y = simulate(PLANT, zeta, u, periodic=True) + 0.05 * g.standard_normal(len(u))
    return TimeRecord(u, y, 0.5, (p,), PERIOD)


def random_record_at(p):
    g = np.random.default_rng(int(100 * p) + 2)
    u, e = g.standard_normal((2, PERIOD * PERIODS))
    return TimeRecord(u, simulate(PLANT, (DEPENDENCE.matrix([[p]]) @ THETA)[0], u, 0.05 * e), 0.5, (p,))


def spectral_record(estimator):
    """A periodic record, or a random one for an estimator that refuses it."""
    try:
        estimator.estimate(record_at(0.5))
    except MisuseError:
        return random_record_at(0.5)
    return record_at(0.5)


def response_at(p):
    g = np.random.default_rng(int(100 * p) + 1)
    omega = np.linspace(0.1, 6.0, 40)
    noise = 0.01 * (g.standard_normal((2, 40)).T @ [1, 1j])
    zeta = (DEPENDENCE.matrix([[p]]) @ THETA)[0]
    return FrequencyResponse(omega, PLANT.plant_response(zeta, omega) + noise, (p,), 0.5, np.full(40, 2e-4))


def data_for(plug_in, p):
    return {TimeRecord: record_at, FrequencyResponse: response_at}[plug_in.data](p)


def arrays_of(value):
    """Every number in a result, in a fixed order."""
    if dataclasses.is_dataclass(value):
        return [a for field in dataclasses.fields(value) for a in arrays_of(getattr(value, field.name))]
    if isinstance(value, tuple):
        return [a for item in value for a in arrays_of(item)]
    return [np.asarray(value)] if isinstance(value, (float, int, np.ndarray)) else []


def same(one, other):
    pairs = zip(arrays_of(one), arrays_of(other), strict=True)
    return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)


def assert_covariance(covariance):
    assert np.allclose(covariance, covariance.T)
    assert np.linalg.eigvalsh(covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))).min() > 0


def test_what_is_there():
    assert set(BASES) >= {"polynomial", "chebyshev", "b_spline"}
    assert set(LTI) >= {"prediction_error"}
    assert set(LPV) >= {"generalised_least_squares", "joint_likelihood"}
    assert set(SUBSPACE) >= {"frequency_subspace", "equidistant_subspace"}


@named(EVERY)
def test_it_is_documented_and_frozen(plug_in):
    assert plug_in.__doc__
    assert not plug_in.__doc__.startswith(f"{plug_in.__name__}(")
    example = plug_in.example()
    assert isinstance(example, plug_in)
    assert example == plug_in.example()
    hash(example)
    for field in dataclasses.fields(plug_in):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(example, field.name, None)


@named(EVERY)
def test_options_say_what_they_are(plug_in):
    for field in dataclasses.fields(plug_in):
        texts = getattr(plug_in.__annotations__[field.name], "__metadata__", ())
        assert texts, f"{plug_in.__name__}.{field.name} is not annotated"
        assert isinstance(texts[0], str)


@named(EVERY)
def test_public_methods_are_documented(plug_in):
    for name, member in vars(plug_in).items():
        if not name.startswith("_") and callable(member):
            assert member.__doc__, f"{plug_in.__name__}.{name}"


@named(BASES.values())
def test_bases_span_what_they_say(plug_in):
    basis = plug_in.example()
    p = np.linspace(2.0, 5.0, 60)
    values = basis.evaluate(p, 2.0, 5.0)
    assert values.shape == (60, basis.size)
    assert np.linalg.matrix_rank(values) == basis.size
    assert np.array_equal(values[7], basis.evaluate(p[7:8], 2.0, 5.0)[0])
    constant = values @ np.linalg.lstsq(values, np.ones(60))[0]
    assert np.allclose(constant, 1.0)


@named(SPECTRAL.values())
def test_spectral_estimates_find_the_response(plug_in):
    record = spectral_record(plug_in.example())
    found = plug_in.example().estimate(record)
    assert same(found, plug_in.example().estimate(record))
    assert found.operating_point == (0.5,)
    assert found.sample_time == 0.5
    truth = PLANT.plant_response((DEPENDENCE.matrix([[0.5]]) @ THETA)[0], found.frequencies)
    inside = found.frequencies < 0.9 * np.pi / 0.5
    assert np.median(abs(found.response - truth)[inside] / abs(truth)[inside]) < 0.1
    if found.variance is not None:
        assert np.all(found.variance > 0)


@named(LTI.values())
def test_local_estimators_find_the_plant(plug_in):
    estimator = plug_in.example()
    data = data_for(plug_in, 0.5)
    found = estimator.estimate(PLANT, data)
    assert same(found, estimator.estimate(PLANT, data))
    assert isinstance(found.model, LocalModel)
    assert found.outcome.ok
    assert found.model.operating_point == (0.5,)
    assert found.fit_percent > 80
    assert_covariance(found.model.covariance)
    error = found.model.zeta - (DEPENDENCE.matrix([[0.5]]) @ THETA)[0]
    assert error @ np.linalg.solve(found.model.covariance, error) < 20
    assert all(0 <= test.p_value <= 1 for test in found.tests)


@named(SUBSPACE.values())
def test_subspace_estimators_find_the_plant(plug_in):
    g = np.random.default_rng(5)
    plant = random_system(g, 2, 2, 2, 0.5)
    omega = np.pi / 0.5 * np.arange(61) / 60
    data = noisy(plant, omega, np.full(61, 0.01), g)
    found = plug_in.example().estimate(data)
    assert same(found, plug_in.example().estimate(data))
    assert isinstance(found, SubspaceEstimate)
    assert found.outcome.ok
    assert found.operating_point == data.operating_point
    assert found.model.stable
    assert relative_error(found.model, plant, omega) < 0.01
    assert found.rms_error <= found.max_error < 0.1


@named(LPV.values())
def test_parameter_varying_estimators_find_the_plant(plug_in):
    estimator = plug_in.example()
    local_estimator = LTI["prediction_error"].example()
    records = [record_at(p) for p in POINTS]
    local = [local_estimator.estimate(PLANT, record) for record in records]
    found = estimator.estimate(PLANT, DEPENDENCE, records, local)
    assert same(found, estimator.estimate(PLANT, DEPENDENCE, records, local))
    assert isinstance(found.model, Model)
    assert found.outcome.ok
    assert found.local == tuple(local)
    assert_covariance(found.model.covariance)
    error = found.model.theta - THETA
    assert error @ np.linalg.solve(found.model.covariance, error) < 25
    assert all(0 <= test.p_value <= 1 for test in found.tests)
