"""Records in a loop: the direct method with a free noise model, against loops computed sample by sample."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from identification import Polynomial, ProductBasis, SchedulingVariable, identify
from identification.errors import MisuseError
from identification.lti.free_noise import errors_in_loop
from identification.lti.initial_conditions import fitted_record
from identification.lti.prediction_error import PredictionError
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord
from tests.support.loops import RESONANT, SLOW, in_loop, integral, late, looped, proportional

PLANT = RationalStructure(1, 0, 1, sample_time=1.0)
TRUTH = np.array([-0.95, 0.5])


def deviations(found, truth=TRUTH):
    return (found.model.zeta - truth) / np.sqrt(np.diag(found.model.covariance))


@pytest.mark.parametrize("noise", [SLOW, RESONANT])
@pytest.mark.parametrize("gains", [(1.0, 0.0), (0.4, 0.02)])
def test_coloured_noise_that_is_fed_back_leaves_no_bias(noise, gains):
    """Without a noise model the pole is far off."""
    found = [
        PredictionError().estimate(PLANT, in_loop(s, noise, integral(*gains), 3000, feedback=True)) for s in (1, 2)
    ]
    assert all(one.outcome.ok for one in found)
    assert np.max(np.abs([deviations(one) for one in found])) < 3.5
    assert all(test.p_value > 1e-3 for one in found for test in one.tests)
    naive = PredictionError().estimate(PLANT, in_loop(1, noise, integral(*gains), 3000))
    assert np.max(abs(deviations(naive))) > 10


def test_the_stated_deviations_are_those_over_runs():
    z = np.array(
        [
            deviations(
                PredictionError().estimate(PLANT, in_loop(s, RESONANT, integral(0.4, 0.02), 1500, feedback=True))
            )
            for s in range(30)
        ]
    )
    assert np.all(abs(z.mean(axis=0)) < 0.6)
    assert np.all((z.std(axis=0) > 0.7) & (z.std(axis=0) < 1.4))


@pytest.mark.parametrize("zeta", [[-0.9, 0.1, 0.45, 0.1], [-1.4, 0.3, 0.45, 0.1]], ids=["stable", "unstable"])
def test_derivatives(zeta):
    structure = RationalStructure(2, 1, 1, sample_time=1.0)
    record = in_loop(3, RESONANT, integral(0.4, 0.02), 800, feedback=True)
    inner, fitted = fitted_record(structure, record, "estimate")
    looped_record = replace(fitted, noise_order=3, colour=(0.3, 0.1))

    def cost(x):
        found = errors_in_loop(inner, x[:4], replace(looped_record, colour=tuple(x[4:])))
        return float(found.errors @ found.errors)

    x = np.array([*zeta, 0.3, 0.1])
    found = errors_in_loop(inner, x[:4], looped_record)
    gradient = 2 * found.errors @ np.concatenate([found.jacobian, found.by_colour], axis=1)
    numeric = [(cost(x + h) - cost(x - h)) / 2e-5 for h in 1e-5 * np.eye(6)]
    assert gradient == pytest.approx(numeric, rel=1e-4, abs=1e-3)


@pytest.mark.parametrize("pole", [1.05, 1.4])
def test_an_unstable_plant_is_measured_in_its_loop(pole):
    z = []
    for seed in range(5):
        g = np.random.default_rng(seed)
        r, v = g.standard_normal(3000), lfilter([1.0], [1.0, -0.5], 0.3 * g.standard_normal(3000))
        u, y = looped(r, v, proportional(0.9), pole)
        found = identify(TimeRecord(u, y, 1.0, (), feedback=True), PLANT)
        z.append((found.model.theta - [-pole, 0.5]) / np.sqrt(np.diag(found.model.covariance)))
    assert np.max(abs(np.array(z))) < 3.5
    assert np.all(abs(np.mean(z, axis=0)) < 1.4)


def test_feedback_that_was_not_stated_is_heeded_and_said():
    record = replace(in_loop(3, RESONANT, proportional(1.0), 3000), operating_point=())
    found = identify(record, PLANT)
    stated = identify(replace(record, feedback=True), PLANT)
    assert np.allclose(found.model.theta, stated.model.theta)
    assert "controller seems to have acted in experiment 1" in found.outcome.advice
    assert found.tests[-1].p_value < 1e-9
    assert "controller" not in stated.outcome.advice


def test_several_records_of_a_parameter_varying_plant():
    """Every record has a noise model and a variance of its own."""
    g = np.random.default_rng(8)
    records = []
    for pole, noise in ((0.9, SLOW), (0.8, RESONANT), (0.7, SLOW)):
        r, v = g.standard_normal(2500), lfilter(*noise, 0.5 * g.standard_normal(2500))
        u, y = looped(r, v, proportional(0.8), pole)
        records.append(TimeRecord(u, y, 1.0, ((0.9 - pole) * 10,), feedback=True))
    over = PLANT.over((SchedulingVariable("p", "", 0.0, 2.0),), ProductBasis((Polynomial(1),)))
    found = identify(records, PLANT, over).model
    z = (found.theta - [-0.9, 0.1, 0.5, 0.0]) / np.sqrt(np.diag(found.covariance))
    assert np.max(abs(z)) < 3.5


def test_a_loop_without_any_delay_cannot_be_judged():
    direct = RationalStructure(1, 1, 0, sample_time=1.0)
    record = in_loop(3, RESONANT, proportional(1.0), 2000, feedback=True)
    with pytest.raises(MisuseError, match="no delay"):
        PredictionError().estimate(direct, record)
    with pytest.raises(MisuseError, match="no delay"):
        PredictionError().estimate(direct, in_loop(3, RESONANT, proportional(1.0), 2000, feedback=True, reference=True))


def test_with_the_reference_a_late_controller_is_known_to_be_late():
    g = np.random.default_rng(1)
    r, v = g.standard_normal(3000), lfilter(*SLOW, 0.3 * g.standard_normal(3000))
    u, y = looped(r, v, late(0.5, 1), direct=0.3)
    direct = RationalStructure(1, 1, 0, sample_time=1.0)
    found = PredictionError().estimate(direct, TimeRecord(u, y, 1.0, (0.0,), feedback=True, reference=r))
    assert np.max(abs(deviations(found, [-0.95, 0.3, 0.5 - 0.95 * 0.3]))) < 3.5


def test_a_response_of_a_loop_without_a_period_is_refused():
    record = replace(in_loop(3, RESONANT, proportional(1.0), 2000, feedback=True), operating_point=())
    with pytest.raises(MisuseError, match="cannot be judged"):
        identify(record, RationalStructure(1, 0, frequency_scale=1.0))
