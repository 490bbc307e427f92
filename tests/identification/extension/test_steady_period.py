"""Steady periods of models with effects against an integrator, filters and formulas that know nothing of them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from identification.bases.polynomial import Polynomial
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.cubic_sensor import CubicSensor
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.drift import Drift
from identification.effects.drift_of_gain import DriftOfGain
from identification.effects.hum import Hum
from identification.effects.integrator import Integrator
from identification.effects.misplaced_point import MisplacedPoint
from identification.effects.quadratic_actuator import QuadraticActuator
from identification.effects.quadratic_damping import QuadraticDamping
from identification.effects.quadratic_sensor import QuadraticSensor
from identification.effects.resonance import Resonance
from identification.effects.second_variable import SecondVariable
from identification.effects.sensor_offset import SensorOffset
from identification.errors import MisuseError
from identification.extension.steady_period import SteadyPeriod, steady_period
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.place import Effect
from identification.places.placed import placed
from identification.places.steady import NoSteadyStateError
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from tests.support.oscillators import MODEL, PERIOD, SAMPLE_TIME, integrated, linear, phasors, played

AMPLITUDES = phasors(np.random.default_rng(5))
INPUT = played(AMPLITUDES, np.arange(PERIOD) * SAMPLE_TIME)


def carrying(*effects: tuple[Effect, float], base: Model = MODEL) -> Model:
    for effect, amplitude in effects:
        base = base.plus(placed(effect, 0, 1, amplitude))
    return base


def simulated(*effects: tuple[Effect, float], p: float = 0.5) -> SteadyPeriod:
    return steady_period(carrying(*effects), INPUT, SAMPLE_TIME, [[p]])


@pytest.mark.parametrize(
    ("effect", "e", "force", "tolerance"),
    [
        (CubicStiffness(), 30.0, lambda x, v: 30.0 * x**3, 1e-4),
        (CubicStiffness(), 800.0, lambda x, v: 800.0 * x**3, 1e-4),
        (CubicStiffness(), 1e4, lambda x, v: 1e4 * x**3, 1e-2),
        (QuadraticDamping(), 0.3, lambda x, v: 0.3 * abs(v) * v, 3e-5),
        (CoulombFriction(), 1.0, lambda x, v: np.tanh(v / 0.004), 4e-3),
    ],
)
def test_forces_in_continuous_time_agree_with_integration(effect, e, force, tolerance):
    wanted = integrated(0.5, AMPLITUDES, force)
    seen = np.linalg.norm(wanted - linear(0.5, AMPLITUDES))
    assert seen > 0.1 * np.linalg.norm(wanted)
    assert np.linalg.norm(simulated((effect, e)).output[0] - wanted) < tolerance * seen


def test_several_effects_in_different_places_at_several_points():
    effects = (QuadraticSensor(), 0.1), (CubicStiffness(), 20.0), (QuadraticActuator(), 0.01), (SensorOffset(), 0.3)
    found = steady_period(carrying(*effects), INPUT, SAMPLE_TIME, [[0.5], [1.0]])
    assert found.left_out == ()
    for p, output in zip((0.5, 1.0), found.output, strict=True):
        way = integrated(p, AMPLITUDES, lambda x, v: 20.0 * x**3, gain=lambda u: u + 0.01 * u**2)
        wanted = way + 0.1 * way**2 + 0.3
        assert np.linalg.norm(output - wanted) < 1e-3 * np.linalg.norm(wanted)


def test_without_effects_and_with_linear_ones_it_is_the_formula():
    np.testing.assert_allclose(simulated().output[0], linear(0.5, AMPLITUDES), atol=1e-12)
    found = simulated((Delay(), 0.05), (Resonance(10.0, 0.05), 1.0)).output[0]

    def late(omega):
        mode = 1 / (100 - omega**2 + 1j * omega)
        return np.exp(-0.05j * omega) * (1 + mode * (35 - omega**2 + 1.5j * omega))

    np.testing.assert_allclose(found, linear(0.5, AMPLITUDES, late), atol=1e-12)


def test_any_samples_in_continuous_time_are_met_by_their_own_interpolation():
    """White samples reach up to the Nyquist frequency, where they are half a cosine; a pure delay moves them."""
    u = np.random.default_rng(1).standard_normal(16)
    structure = RationalStructure(0, 0)
    constant = ParameterDependence((SchedulingVariable("p", "", 0.0, 1.0),), (ProductBasis((Polynomial(0),)),))
    model = Model(structure, constant, np.array([2.0]), np.zeros((1, 1)), 1.0)
    whole = steady_period(carrying((Delay(), 0.3), base=model), u, 0.1, [[0.0]]).output[0]
    np.testing.assert_allclose(whole, 2 * np.roll(u, 3), atol=1e-12)
    half = steady_period(carrying((Delay(), 0.05), base=model), u, 0.1, [[0.0]]).output[0]
    fine = np.zeros(17, dtype=complex)
    fine[:9] = np.fft.rfft(u)
    fine[8] /= 2
    np.testing.assert_allclose(half, 4 * np.roll(np.fft.irfft(fine, 32), 1)[::2], atol=1e-12)


STRUCTURE = RationalStructure(2, 1, n_k=1, sample_time=0.5)
THETA = np.array([-1.2, 0.52, 0.1, 0.4, 0.25])
VARIABLE = (SchedulingVariable("p", "", 0.0, 2.0),)
DISCRETE = Model(
    STRUCTURE,
    ParameterDependence(VARIABLE, tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0, 0))),
    THETA,
    np.diag([1e-4, 1e-4, 1e-5, 1e-4, 1e-4]),
    1.0,
)


def filtered(u: np.ndarray, p: float, cubic: float = 0.0) -> np.ndarray:
    """y(t) = 1.2 y(t−1) − (0.52 + 0.1 p) y(t−2) + 0.4 v(t−1) + 0.25 v(t−2), v = u − cubic y³, after forty periods."""
    if not cubic:
        return lfilter([0, 0.4, 0.25], [1, -1.2, 0.52 + 0.1 * p], np.tile(u, 40))[-len(u) :]
    y, v = np.zeros(40 * len(u)), np.zeros(40 * len(u))
    for t, now in enumerate(np.tile(u, 40)):
        y[t] = 1.2 * y[t - 1] - (0.52 + 0.1 * p) * y[t - 2] + 0.4 * v[t - 1] + 0.25 * v[t - 2]
        v[t] = now - cubic * y[t] ** 3
    return y[-len(u) :]


def test_discrete_time_is_exact_with_and_without_effects():
    u = np.random.default_rng(3).standard_normal(33)
    found = steady_period(DISCRETE, u, 0.5, [[0.0], [2.0]])
    np.testing.assert_allclose(found.output, [filtered(u, 0.0), filtered(u, 2.0)], atol=1e-10)
    model = carrying((CubicStiffness(), 0.02), (CubicSensor(), 0.01), base=DISCRETE)
    way = filtered(u, 1.0, cubic=0.02)
    np.testing.assert_allclose(steady_period(model, u, 0.5, [[1.0]]).output[0], way + 0.01 * way**3, atol=1e-6)


def test_the_deviation_is_that_of_small_changes_of_all_parameters():
    model = carrying((CubicStiffness(), 30.0), (QuadraticSensor(), 0.1), (Resonance(10.0, 0.05), 1.0))
    generator = np.random.default_rng(2)
    factor = generator.standard_normal((len(model.parameters),) * 2) * 1e-3 * abs(model.parameters)[:, None]
    known = replace(model, joint_covariance=factor @ factor.T)
    found = steady_period(known, INPUT, SAMPLE_TIME, [[0.5]])
    draws = [
        steady_period(
            model.with_parameters(model.parameters + factor @ generator.standard_normal(len(factor))),
            INPUT,
            SAMPLE_TIME,
            [[0.5]],
            covariance_known=False,
        ).output[0]
        for _ in range(120)
    ]
    assert found.deviation is not None
    ratio = np.std(draws, axis=0) / found.deviation[0]
    assert np.sqrt(np.mean(ratio**2)) == pytest.approx(1.0, abs=0.15)
    assert steady_period(known, INPUT, SAMPLE_TIME, [[0.5]], covariance_known=False).deviation is None


def test_the_deviation_of_a_model_without_effects_is_that_of_theta():
    u = np.random.default_rng(3).standard_normal(32)
    variance = np.zeros(32)
    for i, sigma in enumerate(np.sqrt(np.diagonal(DISCRETE.covariance))):
        ends = [
            steady_period(
                DISCRETE.with_parameters(THETA + sign * 1e-5 * np.eye(5)[i]), u, 0.5, [[1.0]], covariance_known=False
            ).output[0]
            for sign in (1, -1)
        ]
        variance += sigma**2 * ((ends[0] - ends[1]) / 2e-5) ** 2
    found = steady_period(DISCRETE, u, 0.5, [[1.0]])
    np.testing.assert_allclose(found.deviation, np.sqrt(variance)[None], rtol=1e-3)


def test_what_belongs_to_measurements_is_left_out_and_named():
    tied = (DriftOfGain(), 5.0), (MisplacedPoint(point=0.5), 0.2), (Hum(cycles=4.0), 0.3), (Drift(), 0.2)
    found = simulated(*tied, (Delay(), 0.05))
    np.testing.assert_allclose(found.output, simulated((Delay(), 0.05)).output)
    assert [(one.effect.kind, one.reason.partition(",")[0]) for one in found.left_out] == [
        ("gain_drift", "it belongs to single measurements"),
        ("misplaced_point", "it belongs to single measurements"),
        ("hum", "it is a disturbance in step with the period in which it was found"),
        ("drift", "it is a disturbance in step with the period in which it was found"),
    ]


def test_a_logged_quantity_has_the_value_that_is_stated():
    warm = SecondVariable(coefficient=1, quantity="temperature [K]", reference=300.0)
    model = carrying((warm, 0.5))
    found = steady_period(model, INPUT, SAMPLE_TIME, [[0.5]], {"temperature [K]": 310.0})
    np.testing.assert_allclose(found.output, simulated(p=1.0).output)
    with pytest.raises(MisuseError, match="temperature") as error:
        steady_period(model, INPUT, SAMPLE_TIME, [[0.5]], {"humidity": 0.5})
    assert error.value.field == "logged"


def test_where_there_is_no_steady_state_nothing_is_stated():
    with pytest.raises(NoSteadyStateError, match=r"\(0.5\).*too strong"):
        simulated((CubicStiffness(), -1e4))
    unstable = DISCRETE.with_parameters(np.array([-1.2, 0.52, 0.5, 0.4, 0.25]))
    with pytest.raises(NoSteadyStateError, match=r"\(2\).*unstable"):
        steady_period(unstable, INPUT, 0.5, [[0.0], [2.0]])
    integrating = carrying((Integrator(), 0.1))
    with pytest.raises(MisuseError, match=r"mean value 0.25, and what integrator"):
        steady_period(integrating, INPUT + 0.25, SAMPLE_TIME, [[0.5]])
    found = steady_period(integrating, INPUT, SAMPLE_TIME, [[0.5]])
    np.testing.assert_allclose(
        found.output[0],
        linear(0.5, AMPLITUDES, lambda w: 1 + 0.1 / (1j * w) * (35 - w**2 + 1.5j * w)),
        atol=1e-12,
    )


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"input": [1.0]}, "input"),
        ({"input": [1.0, np.nan]}, "input"),
        ({"sample_time": 0.4}, "sample_time"),
        ({"sample_time": 0.0}, "sample_time"),
        ({"points": [[3.0]]}, "operating_points"),
        ({"points": [[1.0, 1.0]]}, "operating_points"),
    ],
)
def test_misuse_is_named(change, field):
    given = {"input": [1.0, -1.0], "sample_time": 0.5, "points": [[0.0]], **change}
    with pytest.raises(MisuseError) as error:
        steady_period(DISCRETE, **given)
    assert error.value.field == field
