"""Steady states and records from rest with dry friction, against an integration from event to event."""

import numpy as np
import pytest

from benchmarks.dry_friction_bench import STEPS, Plant, asymmetric, coulomb, followed, stribeck
from identification.bases.polynomial import Polynomial
from identification.effects.asymmetric_friction import AsymmetricFriction
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.stribeck_friction import StribeckFriction
from identification.extension.steady_period import record_from_rest, steady_period
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.placed import placed
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

PERIOD, SAMPLE_TIME = 256, 0.01


def model(order, effect=None, e=0.0):
    """1.2 q̈ + 9 q̇ + 1500 q = u, seen as position, velocity or acceleration."""
    structure = RationalStructure(2, order)
    theta = np.array([9 / 1.2, 1500 / 1.2, 1 / 1.2, *np.zeros(order)])
    constant = tuple(ProductBasis((Polynomial(0),)) for _ in theta)
    plain = Model(structure, ParameterDependence((SchedulingVariable("p", "1", -1, 1),), constant), theta, None, 1.0)
    return plain if effect is None else plain.plus(placed(effect, 0, 1, e))


def multisine(rms, seed=0):
    """One period on the grid of half steps."""
    g, lines = np.random.default_rng(seed), np.arange(1, 60)
    spectrum = np.zeros(STEPS * PERIOD + 1, dtype=complex)
    spectrum[lines] = np.exp(2j * np.pi * g.random(len(lines)))
    u = np.fft.irfft(spectrum, n=2 * STEPS * PERIOD)
    return rms * u / np.std(u)


LAWS = {
    "coulomb": (lambda order: CoulombFriction(order), 4.0, coulomb(4.0)),
    "stribeck": (lambda order: StribeckFriction(order, excess=0.5, speed=0.2), 3.0, stribeck(3.0, 0.5, 0.2)),
    "asymmetric": (lambda order: AsymmetricFriction(order, asymmetry=0.4), 3.0, asymmetric(4.2, 1.8)),
}


@pytest.mark.parametrize("rms", [20.0, 9.0])
@pytest.mark.parametrize(("name", "order"), [("coulomb", 0), ("coulomb", 1), ("stribeck", 0), ("asymmetric", 0)])
def test_the_steady_state_is_the_one_that_is_reached(name, order, rms):
    effect, e, law = LAWS[name]
    u = multisine(rms)
    wanted = followed(Plant(1.2, 9.0, 1500.0, law), np.tile(u, 4), SAMPLE_TIME)[order][-PERIOD:]
    played = u[:: 2 * STEPS]
    found = steady_period(model(order, effect(order), e), played, SAMPLE_TIME, [[0.0]]).output[0]
    without = steady_period(model(order), played, SAMPLE_TIME, [[0.0]]).output[0]
    assert np.linalg.norm(found - wanted) < 5e-3 * np.linalg.norm(without - wanted)


@pytest.mark.parametrize("name", ["coulomb", "asymmetric"])
def test_a_record_that_does_not_repeat_is_followed_from_rest(name):
    """Random steps held between the samples, with long rests in which friction holds the mass where it is."""
    effect, e, law = LAWS[name]
    u = np.repeat(np.random.default_rng(4).uniform(-12, 12, 16), 40)
    wanted = followed(Plant(1.2, 9.0, 1500.0, law), u, SAMPLE_TIME)[0]
    found = record_from_rest(model(0, effect(0), e), u, SAMPLE_TIME, [0.0], hold="zero")
    without = record_from_rest(model(0), u, SAMPLE_TIME, [0.0], hold="zero")
    assert np.linalg.norm(found - wanted) < 0.02 * np.linalg.norm(without - wanted)
