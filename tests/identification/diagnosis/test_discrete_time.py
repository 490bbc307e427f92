"""The same for models in discrete time, from periodic records and from records without a period."""

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord
from identification.simulation import simulate

STRUCTURE = RationalStructure(n_a=1, n_b=0, n_k=1, sample_time=0.5)
DEPENDENCE = ParameterDependence(
    (SchedulingVariable("p", "V", 0.0, 1.0),), tuple(ProductBasis((Polynomial(1),)) for _ in range(2))
)
THETA = np.array([-0.7, 0.3, 1.0, 0.5])
MODEL = Model(STRUCTURE, DEPENDENCE, THETA, 1e-12 * np.eye(4), 1.0)
PERIOD, PERIODS = 128, 5


def records(seed, show, periodic=True, delay=0):
    g = np.random.default_rng(seed)
    found = []
    for p in (0.0, 0.25, 0.5, 0.75, 1.0):
        one = g.standard_normal(PERIOD if periodic else 40 * PERIOD)
        u = np.tile(one, PERIODS + 1) if periodic else one
        zeta = DEPENDENCE.matrix([[p]])[0] @ THETA
        y = simulate(STRUCTURE, zeta, np.roll(u, delay) if periodic else u)
        y = show(y) + 0.05 * g.standard_normal(len(u))
        keep = slice(PERIOD, None) if periodic else slice(None)
        found.append(TimeRecord(u[keep], y[keep], 0.5, (p,), PERIOD if periodic else None))
    return gather(found)


def first(found):
    return found.announced[0].score.candidate.effect.kind


@pytest.mark.parametrize("periodic", [True, False])
def test_nothing_is_missing(periodic):
    ps = [compare(MODEL, records(seed, lambda y: y, periodic)).overall.p_value for seed in range(8)]
    assert 0.1 < np.mean(ps) < 0.9


def test_a_cubic_sensor_is_found():
    found = diagnose(MODEL, records(1, lambda y: y + 0.01 * y**3))
    assert first(found) == "cubic_sensor"
    assert found.best.fit.model.effects[0].coefficients[0, 0] == pytest.approx(0.01, rel=0.1)


def test_a_delay_of_one_sample_is_found_as_such():
    found = diagnose(MODEL, records(2, lambda y: y, delay=1))
    assert first(found) == "delay"
    assert found.best.fit.model.effects[0].coefficients[0, 0] == pytest.approx(0.5, rel=0.05)


def test_a_record_without_period_shows_linear_effects():
    found = diagnose(MODEL, records(3, lambda y: y + 0.3 * np.concatenate([[0], y[:-1]]), periodic=False))
    assert found.announced
    assert found.lack_of_fit.p_value < 1e-6


def test_a_record_without_period_shows_a_cubic_sensor():
    found = diagnose(MODEL, records(1, lambda y: y + 0.01 * y**3, periodic=False))
    assert first(found) == "cubic_sensor"
    assert found.best.fit.model.effects[0].coefficients[0, 0] == pytest.approx(0.01, rel=0.05)
    assert found.verdict == "explained"
