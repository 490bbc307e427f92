"""Records of held inputs, made by Runge–Kutta within each hold: fitted, diagnosed and predicted in continuous time."""

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.lag import Lag
from identification.effects.resonance import Resonance
from identification.effects.saturation import Saturation
from identification.extension.steady_period import steady_period
from identification.lti.rational_fit import RationalFit
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.placed import placed
from identification.scheduling import ParameterDependence, ProductBasis
from identification.signals import TimeRecord
from identification.spectral.periodic_average import PeriodicAverage
from tests.support.oscillators import MODEL, POINTS

# ten times the bandwidth of the plant, ω₀ = 5.5 rad/s
STEP, PERIOD, FINER = 0.1, 128, 8


def multisine(generator, level=8.0):
    spectrum = np.zeros(PERIOD // 2 + 1, dtype=complex)
    spectrum[1:60] = np.exp(2j * np.pi * generator.random(59))
    u = np.fft.irfft(spectrum, PERIOD)
    return level * u / u.std()


def played(p, u, hold, force=0.0, lag=0.0, saturation=np.inf):
    """One steady period of x″ + 1.5 x′ + (30 + 10 p) x + force x³ = u, seen through a first-order lag."""
    h, state, found = STEP / FINER, np.zeros(3), []

    def slope(s, drive):
        x, v, seen = s
        return np.array([v, drive - 1.5 * v - (30 + 10 * p) * x - force * x**3, (x - seen) / lag if lag else 0.0])

    for n in range(4 * PERIOD * FINER):
        k, part = divmod(n, FINER)
        here, there = (np.clip(u[i % PERIOD], -saturation, saturation) for i in (k, k + 1))
        rise = (there - here) / FINER if hold == "first" else 0.0
        if part == 0:
            found.append(state[2] if lag else state[0])
        k1 = slope(state, here + rise * part)
        k2 = slope(state + h / 2 * k1, here + rise * (part + 0.5))
        k3 = slope(state + h / 2 * k2, here + rise * (part + 0.5))
        k4 = slope(state + h * k3, here + rise * (part + 1))
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return np.array(found[-PERIOD:])


def records(seed, hold="zero", said="zero", sigma=2e-3, points=POINTS, **more):
    generator = np.random.default_rng(seed)
    made = []
    for p in points:
        u = multisine(generator)
        y = np.tile(played(p, u, hold, **more), 4)
        noise = sigma * y.std() * generator.standard_normal(len(y))
        made.append(TimeRecord(np.tile(u, 4), y + noise, STEP, (p,), PERIOD, hold=said))
    return made


@pytest.fixture(scope="module")
def held():
    return records(1)


@pytest.mark.parametrize("hold", ["zero", "first"])
def test_no_delay_is_found_and_parameters_lie_within_their_deviations(hold):
    (record,) = records(3, hold, hold, points=(0.5,))
    data = PeriodicAverage(continuous_time=True).estimate(record)
    assert data.held == record.held
    found = RationalFit().estimate(RationalStructure(2, 0, delay=True), data)
    deviations = np.sqrt(np.diagonal(found.model.covariance))
    assert np.all(abs(found.model.zeta - [1.5, 35.0, 1.0, 0.0]) < 3.5 * deviations)
    assert deviations[-1] < STEP / 100
    assert found.tests[0].p_value > 1e-3


def test_a_stated_hold_leaves_nothing_to_find_and_an_unstated_one_half_a_sample(held):
    found = diagnose(MODEL, gather(held))
    assert found.verdict == "nothing missing"
    assert found.lack_of_fit.p_value > 1e-3
    assert compare(MODEL, gather(held)).overall.p_value > 1e-3
    deaf = [TimeRecord(r.input, r.output, STEP, r.operating_point, PERIOD, hold="band") for r in held]
    assert diagnose(MODEL, gather(deaf)).lack_of_fit.p_value < 1e-9


def test_effects_are_found_behind_a_held_input_with_their_amplitude():
    for more, kind, amplitude in (({"force": 15.0}, "cubic_stiffness", 15.0), ({"lag": 0.05}, "lag", 0.05)):
        found = diagnose(MODEL, gather(records(4, **more)))
        assert found.best.score.candidate.effect.kind == kind
        assert found.best.fit.model.effects[-1].coefficients[0, 0] == pytest.approx(amplitude, rel=0.03)


@pytest.mark.parametrize(
    ("more", "effect", "amplitude"),
    [
        ({"lag": 0.07}, Lag(), 0.07),
        ({"force": 10.0}, CubicStiffness(), 10.0),
        ({"saturation": 9.0}, Saturation(9.0), 1.0),
        ({}, None, 0.0),
    ],
)
@pytest.mark.parametrize("hold", ["zero", "first"])
def test_a_steady_period_of_a_held_input_is_what_integration_gives(hold, more, effect, amplitude):
    u = multisine(np.random.default_rng(5))
    model = MODEL if effect is None else MODEL.plus(placed(effect, 0, 1, amplitude))
    found = steady_period(model, u, STEP, [[0.0]], hold=hold, covariance_known=False).output[0]
    truth = played(0.0, u, hold, **more)
    rough = steady_period(model, u, STEP, [[0.0]], covariance_known=False).output[0]
    error, without = (np.linalg.norm(y - truth) / np.linalg.norm(truth) for y in (found, rough))
    exact = effect is None or "lag" in more or ("saturation" in more and hold == "zero")
    assert error < (1e-4 if exact else 5e-3)
    assert without > 10 * error


def test_a_mode_beside_the_plant_is_seen_through_the_hold_too():
    """Two modes in parallel are one fourth-order plant: exact there, by images here."""
    u = multisine(np.random.default_rng(6))
    mode = Resonance(frequency=9.0, damping=0.05)
    found = steady_period(MODEL.plus(placed(mode, 0, 1, 0.4)), u, STEP, [[0.0]], hold="zero", covariance_known=False)
    first, second = np.array([1.0, 1.5, 30.0]), np.array([1.0, 0.9, 81.0])
    zeta = np.concatenate([np.polymul(first, second)[1:], np.polyadd(second, 0.4 * first)])
    base = _constant(RationalStructure(4, 2), zeta)
    truth = steady_period(base, u, STEP, [[0.0]], hold="zero", covariance_known=False)
    assert np.linalg.norm(found.output - truth.output) < 1e-3 * np.linalg.norm(truth.output)


def _constant(structure, zeta):
    how = ParameterDependence(MODEL.dependence.variables, (ProductBasis((Polynomial(0),)),) * structure.size)
    return Model(structure, how, zeta, np.eye(structure.size), 1.0)
