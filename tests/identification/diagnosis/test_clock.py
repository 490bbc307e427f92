"""Clocks that run fast or slow: named as that, sized, told from delays and drifts, and followed in predictions.

The truth is a sum of sines, evaluated at the instants at which the recorder really took its samples.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from identification.bases.polynomial import Polynomial
from identification.comparison.clock import clock_of
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.diagnosis.staircase import relative_error, staircase
from identification.effects.clock_skew import ClockSkew
from identification.extension.as_recorded import as_recorded
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.placed import placed
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord

STEP, POINTS = 0.05, (0.0, 0.5, 1.0)
POSITION = SchedulingVariable("position", "m", 0.0, 1.0)
DEPENDENCE = ParameterDependence((POSITION,), tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0)))
MODEL = Model(RationalStructure(2, 0), DEPENDENCE, np.array([1.4, 85.0, 55.0, 1.25]), np.eye(4), 1.0)


def response(p, omega):
    return 1.25 / (85 + 55 * p - omega**2 + 1.4j * omega)


def sines(amplitudes, omega, time):
    return np.real(np.exp(1j * np.multiply.outer(time, omega)) @ amplitudes)


def records(seed, skew, periods=4, period=200, noise=0.01, late=0.0, spacing=2):
    """Two at each point; the output's clock is fast by the share `skew`, what it shows `late` by some seconds."""
    g = np.random.default_rng(seed)
    lines = np.arange(1, period // 4, spacing)
    omega = 2 * np.pi * lines / (period * STEP)
    time = STEP * np.arange(periods * period)
    found = []
    for p in np.repeat(POINTS, 2):
        force = np.exp(2j * np.pi * g.random(len(lines)))
        y = sines(response(p, omega) * force, omega, time * (1 + skew) - late)
        y += noise * y.std() * g.standard_normal(len(time))
        found.append(TimeRecord(sines(force, omega, time), y, STEP, (p,), period, hold="band"))
    return found


def without_period(seed, skew, late=0.0, samples=1500):
    """Sines at frequencies that no period of the record holds."""
    g = np.random.default_rng(seed)
    omega = np.sort(g.uniform(1.0, 30.0, 60))
    time = STEP * np.arange(samples)
    found = []
    for p in POINTS:
        force = np.exp(2j * np.pi * g.random(len(omega)))
        y = sines(response(p, omega) * force, omega, time * (1 + skew) - late)
        y += 0.01 * y.std() * g.standard_normal(samples)
        found.append(TimeRecord(sines(force, omega, time), y, STEP, (p,), hold="band"))
    return found


def kinds(found):
    return [one.score.candidate.effect.kind for one in found.announced]


@pytest.mark.parametrize(("skew", "periods"), [(2e-5, 8), (-7e-5, 4), (4e-4, 2), (-1.5e-3, 3), (3e-3, 12)])
def test_it_is_named_and_its_size_lies_within_its_deviation(skew, periods):
    found = diagnose(MODEL, gather(records(1, skew, periods)))
    assert kinds(found) == ["clock_skew"]
    assert found.confident
    effect, model = found.best.fit.model.effects[-1], found.best.fit.model
    deviation = float(np.sqrt(model.joint_covariance[-1, -1]))
    assert abs(float(effect.coefficients[0, 0]) - skew) < 4 * deviation
    assert deviation < 0.1 * abs(skew)


def test_its_deviation_is_that_of_repeated_runs():
    scaled = []
    for seed in range(12):
        model = diagnose(MODEL, gather(records(seed, 2e-4, spacing=5)), [ClockSkew()]).best.fit.model
        off = float(model.effects[-1].coefficients[0, 0]) - 2e-4
        scaled.append(off / float(np.sqrt(model.joint_covariance[-1, -1])))
    assert 0.4 < np.std(scaled) < 1.8
    assert abs(np.mean(scaled)) < 1.2


def test_the_error_on_other_data_falls_to_the_noise():
    data, others = gather(records(2, 3e-4)), gather(records(3, 3e-4))
    steps = staircase(MODEL, data, others)
    assert [one.effect.kind for one in steps[-1].model.effects] == ["clock_skew"]
    assert steps[-1].held_out_error < 0.1 * steps[0].held_out_error
    assert relative_error(steps[-1].model, others) < 0.005


@pytest.mark.parametrize("late", [0.02, 0.06])
def test_a_delay_is_not_called_a_clock(late):
    found = diagnose(MODEL, gather(records(4, 0.0, late=late)))
    assert kinds(found)[0] == "delay"
    assert "clock_skew" not in kinds(found)
    assert "clock_skew" not in kinds(diagnose(MODEL, gather(without_period(4, 0.0, late=late))))


@pytest.mark.parametrize("skew", [-2e-4, 6e-4])
def test_without_a_period_it_is_named_as_well(skew):
    steps = staircase(MODEL, gather(without_period(5, skew)))
    assert kinds(steps[0].diagnosis) == ["clock_skew"]
    (effect,) = steps[-1].model.effects
    deviation = float(np.sqrt(steps[-1].model.joint_covariance[-1, -1]))
    assert abs(float(effect.coefficients[0, 0]) - skew) < 4 * deviation
    assert deviation < 0.02 * abs(skew)


def test_a_delay_and_a_clock_are_both_found():
    steps = staircase(MODEL, gather(records(6, -3e-4, late=0.02)))
    added = {one.effect.kind: float(one.coefficients[0, 0]) for one in steps[-1].model.effects}
    assert set(added) == {"clock_skew", "delay"}
    assert added["clock_skew"] == pytest.approx(-3e-4, rel=0.02)
    assert added["delay"] == pytest.approx(0.02, rel=0.02)


def test_a_plant_that_drifts_within_the_records_is_no_clock():
    """A spring that softens by a tenth over the record, and one that grows hard in the other record."""
    found = []
    for seed, change in enumerate((-0.1, 0.07, -0.12)):
        g = np.random.default_rng(seed)
        omega = 2 * np.pi * np.arange(1, 40, 2) / (200 * STEP)
        force = np.exp(2j * np.pi * g.random(len(omega)))
        time = STEP * np.arange(800)

        def slope(t, x, change=change, force=force, omega=omega):
            spring = 85 * (1 + change * t / 40)
            return [x[1], 1.25 * float(sines(force, omega, np.array([t]))[0]) - 1.4 * x[1] - spring * x[0]]

        y = solve_ivp(slope, (-20, 40), [0, 0], t_eval=time, rtol=1e-6, atol=1e-9).y[0]
        y += 0.005 * y.std() * g.standard_normal(len(y))
        found.append(TimeRecord(sines(force, omega, time), y, STEP, (0.0,), 200))
    assert clock_of(found) == 0.0


def test_noise_alone_shows_no_clock():
    assert [clock_of(records(seed, 0.0, noise=0.1)) for seed in range(20)] == [0.0] * 20


def test_a_record_that_begins_at_rest_shows_no_clock_and_hides_none():
    for skew in (0.0, 4e-4):
        found = records(7, skew)
        settling = 3 * found[0].output.std() * np.exp(-np.arange(800) / 30)
        found = [replace(one, output=one.output + settling) for one in found]
        assert clock_of(found) == pytest.approx(skew, rel=0.03)


def test_predictions_are_on_the_clock_of_the_recorder():
    omega = 2 * np.pi * np.arange(1, 30) / (200 * STEP)
    amplitudes = response(0.5, omega) * np.exp(1j * np.arange(29.0) ** 2)
    time = STEP * np.arange(1000)
    model = MODEL.plus(placed(ClockSkew(), 0, 1, 1e-3))
    period = sines(amplitudes, omega, time[:200])
    shown = as_recorded(model, period, STEP, np.array([0.5]), 1000)
    truth = sines(amplitudes, omega, time * 1.001)
    assert np.max(abs(shown - truth)) < 1e-4 * truth.std()
    assert np.max(abs(as_recorded(MODEL, period, STEP, np.array([0.5]), 1000) - np.tile(period, 5))) == 0
