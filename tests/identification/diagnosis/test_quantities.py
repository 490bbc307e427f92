"""Springs act on the displacement and friction on the flow, whatever the sensor shows; strong ones are used, too."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from identification.bases.polynomial import Polynomial
from identification.channels import Channel, Channels
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.effects.library import library
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord
from tests.support.oscillators import PERIOD, SAMPLE_TIME, phasors, played

POINTS = (-1.0, 0.0, 1.0)
SEEN = ("position", "velocity", "acceleration")
CUBIC, DRAG, COULOMB = "cubic_stiffness", "quadratic_damping", "coulomb_friction"
FORCES = {
    CUBIC: (150.0, lambda x, v: x**3),
    DRAG: (0.5, lambda x, v: abs(v) * v),
    COULOMB: (1.5, lambda x, v: np.tanh(v / 2e-3)),
}
MECHANICAL = [one for one in library("mechanical") if one.needs_records]


def model(order):
    """1/(s² + 1.5 s + 30 + 10 p) s^d, all of B free."""
    degrees = (0, 1, *(0 for _ in range(order + 1)))
    variables = (SchedulingVariable("p", "1", -1.0, 1.0),)
    dependence = ParameterDependence(variables, tuple(ProductBasis((Polynomial(n),)) for n in degrees))
    theta = np.array([1.5, 30.0, 10.0, 1.0, *np.zeros(order)])
    return Model(RationalStructure(2, order), dependence, theta, 1e-12 * np.eye(len(theta)), 1.0)


def measured(kind, order, stated, seed=2):
    """Two periods of an adaptive integrator, the second with noise of three thousandths."""
    g = np.random.default_rng(seed)
    e, force = FORCES[kind]
    found = []
    for p in POINTS:
        amplitudes = phasors(g)

        def slope(t, s, p=p, amplitudes=amplitudes):
            rate = played(amplitudes, t) - (30 + 10 * p) * s[0] - 1.5 * s[1] - e * force(s[0], s[1])
            return [s[1], rate]

        times = (PERIOD + np.arange(PERIOD)) * SAMPLE_TIME
        x, v = solve_ivp(slope, (0, times[-1]), [0, 0], t_eval=times, rtol=1e-8, atol=1e-10, max_step=0.01).y
        shown = (x, v, np.array([slope(t, s)[1] for t, s in zip(times, np.stack([x, v], 1), strict=True)]))[order]
        y = np.tile(shown, 4) + 3e-3 * np.std(shown) * g.standard_normal(4 * PERIOD)
        u = np.tile(played(amplitudes, np.arange(PERIOD) * SAMPLE_TIME), 4)
        channels = Channels(Channel("", "force", "N"), Channel("", SEEN[order])) if stated else Channels()
        found.append(TimeRecord(u, y, SAMPLE_TIME, (p,), PERIOD, channels))
    return gather(found)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("kind", list(FORCES))
def test_with_stated_quantities_the_effect_is_first_with_its_amplitude(kind, order):
    found = diagnose(model(order), measured(kind, order, True), MECHANICAL)
    best = found.best.fit.model.effects[-1]
    assert (best.effect.kind, best.effect.order) == (kind, order)
    deviation = np.sqrt(found.best.fit.model.joint_covariance[-1, -1])
    assert abs(best.coefficients[0, 0] - FORCES[kind][0]) < max(0.06 * FORCES[kind][0], 4 * deviation)
    assert found.best.share > 0.98


def test_without_stated_quantities_the_order_is_found_with_the_effect():
    found = diagnose(model(1), measured(COULOMB, 1, False), MECHANICAL)
    best = found.best.fit.model.effects[-1].effect
    assert (best.kind, best.order) == (COULOMB, 1)


def test_a_cube_of_the_output_is_a_spring_or_a_damper_and_is_tried_once():
    """The lower order stands for both: a cubic spring if y is a position, a cubic damper if y is a speed."""
    found = diagnose(model(0), measured(CUBIC, 0, False), MECHANICAL)
    assert found.best.score.candidate.effect.kind == CUBIC
    damping = next(s for s in found.scores if s.candidate.effect.kind == "cubic_damping")
    assert {one.placed.effect.order for one in damping.candidate.signatures} == {0}


def test_a_strong_spring_is_named_and_its_model_is_used():
    """A misfit of two fifths; the model that is announced answers at another level of the input as well."""
    (batch,) = measured(CUBIC, 0, True)
    found = diagnose(model(0), (batch,), MECHANICAL)
    assert found.confident
    assert np.linalg.norm(found.base.residual) ** 2 > 0.05 * np.linalg.norm(batch.measured) ** 2
    louder = replace(batch, inputs=1.5 * batch.inputs, signals=1.5 * batch.signals)
    assert np.all(np.isfinite(found.best.fit.model.output(louder)))
