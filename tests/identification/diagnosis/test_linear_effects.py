"""Linear effects and dependence on p in plants that are integrated or written out here, each named with its size."""

from dataclasses import replace

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.effects.cpe_exponent import CpeExponent
from identification.effects.low_basis import LowBasis
from identification.effects.misplaced_point import MisplacedPoint
from identification.effects.rc_arc import RcArc
from identification.effects.two_mass import TwoMass
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.placed import placed
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse, TimeRecord

OMEGA = 2 * np.pi * np.arange(1, 80, 2) / 12.8


def model_of(structure, degrees, theta):
    """With one scheduling variable p = 0 … 1."""
    bases = tuple(ProductBasis((Polynomial(degree),)) for degree in degrees)
    how = ParameterDependence((SchedulingVariable("p", "1", 0.0, 1.0),), bases)
    return Model(structure, how, np.array(theta, dtype=float), np.eye(how.size), 1.0)


def responses(plant, points, seed=0, noise=2e-3, omega=OMEGA, known=True):
    """Measured responses of plant(p, s) with relative noise."""
    generator, found = np.random.default_rng(seed), []
    for p in points:
        exact = plant(p, 1j * omega)
        error = generator.standard_normal(len(omega)) + 1j * generator.standard_normal(len(omega))
        sigma = noise * abs(exact)
        variance = sigma**2 if known else None
        found.append(FrequencyResponse(omega, exact + sigma * error / np.sqrt(2), (p,), None, variance))
    return gather(found)


def named(found):
    return [one.score.candidate.effect.kind for one in found.announced]


POINTS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
FIRST = model_of(RationalStructure(1, 0), (1, 1), [2.0, -1.0, 1.0, -0.5])
SECOND = model_of(RationalStructure(2, 0), (0, 1, 0), [1.5, 40.0, -20.0, 1.0])


def test_a_motor_whose_inertia_is_linear_in_p_is_another_normalisation():
    found = diagnose(FIRST, responses(lambda p, s: 1 / ((0.5 + p) * s + 1.2), POINTS))
    assert named(found)[0] == "low_basis"
    assert found.verdict == "explained"
    best = found.best.fit.model.effects[-1]
    assert best.effect.coefficient == -1
    # J = 1 + 0.5 p̃
    assert best.coefficients[0, 0] == pytest.approx(0.5, abs=0.02)


def test_a_stiffness_that_goes_as_one_over_p_is_found_in_its_coefficient():
    found = diagnose(SECOND, responses(lambda p, s: 1 / (s**2 + 1.5 * s + 40 / (0.6 + p)), POINTS, seed=1))
    assert named(found)[0] == "low_basis"
    best = found.best.fit.model.effects[-1]
    assert best.effect.coefficient == 1
    assert best.coefficients[0, 0] == pytest.approx(0.5 / 1.1, abs=0.02)


@pytest.mark.parametrize("misplaced", [0.0, 0.4, 1.0])
def test_the_point_that_was_logged_wrongly_is_the_one_that_explains_most(misplaced):
    """Two records at it and one elsewhere: noise variances of other freedom must not decide."""

    def plant(p, s):
        at = p + 0.08 * (1 if p < 1 else -1) * (p == misplaced)
        return 1 / (s**2 + 1.5 * s + 40 - 20 * at)

    found = diagnose(SECOND, responses(plant, (*POINTS, misplaced), seed=2))
    assert named(found)[0] == "misplaced_point"
    (best,) = [one for one in found.evidence if one.score.candidate.effect == MisplacedPoint()]
    assert best.fit.model.effects[-1].effect.point == pytest.approx(2 * misplaced - 1)


def test_a_depressed_arc_of_the_model_has_its_exponent():
    cell = model_of(RationalStructure(1, 1, frequency_scale=20.0), (0, 0, 1), [1.0, 0.05, 0.1, 0.02])
    omega = np.geomspace(0.1, 2000, 60)

    def plant(p, s):
        return 0.05 + (0.05 + 0.02 * p) / (1 + (s / 20) ** 0.85)

    found = diagnose(cell, responses(plant, POINTS, 3, omega=omega))
    assert named(found)[0] == "cpe_exponent"
    assert found.best.fit.model.effects[-1].coefficients[0, 0] == pytest.approx(0.15, abs=0.01)


def test_an_arc_whose_time_moves_with_p_is_followed():
    cell = model_of(RationalStructure(1, 1, frequency_scale=20.0), (0, 0, 0), [1.0, 0.05, 0.1])
    omega = np.geomspace(0.01, 2000, 60)

    def plant(p, s):
        return 0.05 + 0.05 / (1 + s / 20) + 0.03 / (1 + s * 1.5 * 3.0**p)

    found = diagnose(cell, responses(plant, POINTS, 4, omega=omega))
    assert named(found)[0] == "rc_arc"
    assert found.verdict == "explained"
    arc = found.best.fit.model.effects[-1].effect
    assert arc.ratio == pytest.approx(3.0, rel=0.1)
    assert arc.time == pytest.approx(1.5 * np.sqrt(3), rel=0.05)


def driven(p, order, friction=0.0):
    """Of 0.5 v₁′ + v₁ = u − f, m v₂′ = f − friction v₂, f = k (x₁ − x₂) + c (v₁ − v₂), m = 0.1 + 0.1 p."""
    m, k, c = 0.1 + 0.1 * p, 8.0, 0.03
    rate = np.array([[0, 1, 0, 0], [-k, -c - 1, k, c], [0, 0, 0, 1], [k, c, -k, -c]], dtype=float)
    rate[1] /= 0.5
    rate[3, 3] -= friction
    rate[3] /= m
    seen = {0: np.array([1.0, 0, 0, 0]), 1: np.array([0, 1.0, 0, 0])}[order]

    def response(s):
        push = np.array([0, 1 / 0.5, 0, 0])
        return np.array([seen @ np.linalg.solve(one * np.eye(4) - rate, push) for one in s])

    return response


@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("friction", [0.0, 0.06])
def test_two_masses_are_one_equation_for_a_speed_and_a_position(order, friction):
    """The response of the extended model at the true mass is that of the states, pole and zero moving with p."""
    rigid = model_of(RationalStructure(1, 0), (0, 0), [2.0, 2.0])
    if order == 0:
        rigid = model_of(RationalStructure(2, 0), (0, 0, 0), [2.0, 0.0, 2.0])
    zero = float(np.sqrt(8.0 / 0.15))
    growing = TwoMass(frequency=zero, damping=0.03 / 8 * zero / 2, ratio=2.0, friction=friction / 0.15, order=order)
    batch = responses(lambda p, s: driven(p, order, friction)(s), POINTS, noise=1e-6)[0]
    answered = rigid.plus(placed(growing, 0, 1, 0.15)).output(batch)
    assert np.allclose(answered, batch.outputs, rtol=1e-4)


def test_a_second_mass_is_named():
    rigid = model_of(RationalStructure(1, 0), (0, 0), [2.0, 2.0])
    found = diagnose(rigid, responses(lambda p, s: driven(0.5, 1)(s), (0.5,), 5))
    assert named(found)[0] == "two_mass"
    assert found.best.fit.model.effects[-1].effect.order == 1
    best = found.best.fit.model.effects[-1]
    assert best.coefficients[0, 0] == pytest.approx(0.15, rel=0.05)
    assert best.effect.frequency == pytest.approx(np.sqrt(8 / 0.15), rel=0.01)


@pytest.mark.parametrize("tau", [0.1, 3.0])
def test_a_delay_of_many_turns_is_named_with_its_length(tau):
    """A logarithmic sweep; the refit without the delay bends all parameters, the scan begins from the stated ones."""
    first = model_of(RationalStructure(1, 0), (1, 1), [1.0, -0.4, 1.0, -0.4])
    omega = 2 * np.pi * np.geomspace(0.1, 10, 40)

    def plant(p, s):
        return (1 - 0.4 * p) / (s + 1 - 0.4 * p) * np.exp(-s * tau)

    found = diagnose(first, responses(plant, (0.0, 0.5, 1.0), 6, noise=1e-2, omega=omega))
    assert named(found)[0] == "delay"
    assert found.verdict == "explained"
    assert found.best.fit.model.effects[-1].coefficients[0, 0] == pytest.approx(tau, abs=2e-4)


def held_records(said):
    """x″ + 1.5 x′ + (40 − 20 p) x = u, u held, filtered by its exact sampled form written out here."""
    generator, found, step, period = np.random.default_rng(7), [], 0.1, 128
    for p in POINTS:
        u = generator.standard_normal(period)
        rate = np.array([[0.0, 1.0], [-(40 - 20 * p), -1.5]])
        values, vectors = np.linalg.eig(rate)
        turn = (vectors * np.exp(values * step) @ np.linalg.inv(vectors)).real
        push = np.linalg.solve(rate, (turn - np.eye(2)) @ np.array([0.0, 1.0]))
        state, y = np.zeros(2), []
        for n in range(6 * period):
            y.append(state[0])
            state = turn @ state + push * u[n % period]
        y = np.tile(y[-period:], 4)
        y = y + 3e-3 * y.std() * generator.standard_normal(len(y))
        found.append(TimeRecord(np.tile(u, 4), y, step, (p,), period, hold=said))
    return gather(found)


def test_an_unstated_hold_is_named_and_a_stated_one_not_looked_for():
    found = diagnose(SECOND, held_records(None))
    assert named(found)[0] == "input_hold"
    amplitude = found.best.fit.model.effects[-1].coefficients[0, 0]
    assert amplitude == pytest.approx(1.0, abs=0.03)
    stated = diagnose(SECOND, held_records("zero"))
    assert stated.verdict == "nothing missing"
    (unseen,) = [one for one in stated.visibility if one.effect.kind == "input_hold"]
    assert not unseen.judged
    assert "stated" in unseen.reason


def test_derivatives_by_coefficients_hold_while_effects_reshape_and_divide():
    """The fit to exact data of a model with three such effects comes back to its parameters."""
    omega = np.geomspace(0.1, 2000, 60)
    cell = model_of(RationalStructure(1, 1, frequency_scale=20.0), (0, 0, 1), [1.0, 0.05, 0.1, 0.02])
    for effect, amplitude in ((CpeExponent(), 0.2), (LowBasis(degree=1), 0.3), (RcArc(1.0, ratio=2.0), 0.02)):
        true = cell.plus(placed(effect, 0, 1, amplitude))
        batch = responses(lambda p, s: np.ones(len(s)), POINTS, omega=omega)[0]
        rows = Rows((replace(batch, outputs=true.output(batch), variances=np.full(batch.outputs.shape, 1e-8)),))
        start = true.with_parameters(true.parameters * 1.05)
        again = fit(start, rows)
        assert again.outcome.ok
        assert np.allclose(again.model.parameters, true.parameters, rtol=1e-4)
