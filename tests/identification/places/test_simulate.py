"""Steady responses with effects against an adaptive integrator that knows nothing of harmonics."""

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.hysteresis import Hysteresis
from identification.effects.quadratic_actuator import QuadraticActuator
from identification.effects.quadratic_damping import QuadraticDamping
from identification.effects.quadratic_sensor import QuadraticSensor
from identification.effects.rc_arc import RcArc
from identification.effects.resonance import Resonance
from identification.errors import MisuseError
from identification.places.placed import placed
from identification.signals import FrequencyResponse
from tests.support.oscillators import MODEL, OMEGA, batches, integrated, linear, phasors, played, records

AMPLITUDES = phasors(np.random.default_rng(5))


def modelled(*effects):
    model = MODEL
    for effect, e in effects:
        model = model.plus(placed(effect, 0, 1, e))
    (batch,) = gather(records([(AMPLITUDES, linear(0.5, AMPLITUDES))], np.random.default_rng(0), 1e-3, points=(0.5,)))
    return batch.signal(model.output(batch))[0]


def close(found, wanted, tolerance):
    base = linear(0.5, AMPLITUDES)
    assert np.linalg.norm(wanted - base) > 0.02 * np.linalg.norm(base), "the effect must be visible for the test"
    return np.linalg.norm(found - wanted) < tolerance * np.linalg.norm(wanted - base)


@pytest.mark.parametrize(
    ("effect", "e", "force"),
    [
        (CubicStiffness(), 30.0, lambda x, v: 30.0 * x**3),
        (QuadraticDamping(), 0.3, lambda x, v: 0.3 * abs(v) * v),
    ],
)
def test_feedback_agrees_with_integration_in_time(effect, e, force):
    assert close(modelled((effect, e)), integrated(0.5, AMPLITUDES, force), 1e-3)


def test_two_effects_at_once_and_in_different_places():
    wanted = integrated(0.5, AMPLITUDES, lambda x, v: 20.0 * x**3, gain=lambda u: u + 0.01 * u**2)
    wanted = wanted + 0.1 * wanted**2
    found = modelled((QuadraticSensor(), 0.1), (CubicStiffness(), 20.0), (QuadraticActuator(), 0.01))
    assert close(found, wanted, 2e-3)


def test_linear_effects_are_what_their_formula_says():
    t = np.arange(128) * 0.1
    assert close(modelled((Delay(), 0.05)), linear(0.5, AMPLITUDES, lambda w: np.exp(-0.05j * w)), 1e-9)
    mode = 1 / (100 - OMEGA**2 + 1j * OMEGA)
    shown = linear(0.5, AMPLITUDES, lambda w: np.exp(-0.05j * w)) + played(
        mode * np.exp(-0.05j * OMEGA) * AMPLITUDES, t
    )
    assert close(modelled((Delay(), 0.05), (Resonance(10.0, 0.05), 1.0)), shown, 1e-9)
    arc = played(0.01 / (1 + 0.4j * OMEGA) * AMPLITUDES, t)
    assert close(modelled((RcArc(time=0.4), 0.01)), linear(0.5, AMPLITUDES) + arc, 1e-9)
    both = linear(0.5, AMPLITUDES, lambda w: np.exp(-0.05j * w)) + arc
    assert close(modelled((Delay(), 0.05), (RcArc(time=0.4), 0.01)), both, 1e-9)


def test_hysteresis_takes_energy_out():
    base, with_it = modelled(), modelled((Hysteresis(travel=0.1), 2.0))
    assert np.linalg.norm(with_it) < np.linalg.norm(base)


def test_effects_on_signals_need_records():
    (batch,) = gather([FrequencyResponse(OMEGA, np.ones(len(OMEGA)), (0.0,), variance=np.ones(len(OMEGA)))])
    with pytest.raises(MisuseError, match="periodic records"):
        MODEL.plus(placed(CubicStiffness(), 0, 1, 1.0)).output(batch)
    assert np.all(np.isfinite(MODEL.output(batch)))
    assert len(batches()) == 1
