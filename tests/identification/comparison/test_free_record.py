"""Records that do not repeat: transients, noise and effects, against plants integrated in small steps."""

import numpy as np
import pytest

from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose, misfit, rows_of
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.dead_zone import DeadZone
from identification.effects.delay import Delay
from identification.effects.quadratic_damping import QuadraticDamping
from identification.effects.saturation import Saturation
from identification.extension.fit import fit
from tests.support.motions import INPUTS, POINTS, continuous, integrated, model, nothing, played, records, white

SAMPLES = 800
SOME = (CoulombFriction(), CubicStiffness(), DeadZone(), Delay(), QuadraticDamping(), Saturation())


def campaign(kind, seed, force=nothing, noise=0.03, samples=SAMPLES):
    g = np.random.default_rng(seed)
    signals = INPUTS[kind](g, samples)
    return gather(records(*integrated(played(signals), samples, force), noise, g))


@pytest.mark.parametrize("start", [model, continuous])
def test_what_was_before_the_record_costs_nothing(start):
    """Without noise the response is exact whatever the state at the start; without transients it is 5 % off."""
    g = np.random.default_rng(0)
    signals = white(g, 300)
    found = integrated(played(signals), 300, start=(0.5, -3.0))
    batches = gather(records(*found, 1e-7, g))
    base = fit(start(), rows_of(start(), batches))
    omega = np.linspace(0.5, 20.0, 30)
    points = POINTS[:, None]
    held = batches[0].held
    right, got = (m.structure.plant_response(m.coefficients(points), omega, held) for m in (continuous(), base.model))
    if start is model:
        right = continuous().structure.plant_response(continuous().coefficients(points), omega, held)
    assert np.max(abs(got / right - 1)) < 1e-4


@pytest.mark.parametrize("kind", sorted(INPUTS))
def test_the_lack_of_fit_is_small_where_nothing_is_missing(kind):
    ps = []
    for seed in range(6):
        rows = rows_of(model(), campaign(kind, seed))
        ps.append(misfit("lack of fit", fit(model(), rows)).p_value)
    assert min(ps) > 0.001
    assert np.mean(ps) > 0.15


@pytest.mark.parametrize(
    ("kind", "effect", "force", "amplitude"),
    [
        ("white", "coulomb_friction", lambda x, v: 0.06 * np.tanh(v / 1e-3), 0.06),
        ("two_levels", "cubic_stiffness", lambda x, v: 0.1 * x**3, 0.1),
        ("chirp", "quadratic_damping", lambda x, v: 0.006 * abs(v) * v, 0.006),
        ("steps", "cubic_stiffness", lambda x, v: 0.02 * x**3, 0.02),
    ],
)
def test_effects_on_signals_are_found_and_measured(kind, effect, force, amplitude):
    found = diagnose(model(), campaign(kind, 1, force), SOME)
    assert [one.score.candidate.effect.kind for one in found.announced] == [effect]
    assert found.lack_of_fit.p_value < 1e-6
    assert found.verdict in ("explained", "partly explained")
    assert found.best.fit.model.effects[0].coefficients[0, 0] == pytest.approx(amplitude, rel=0.1)


def test_what_two_levels_cannot_show_is_listed():
    found = diagnose(model(), campaign("two_levels", 3), (DeadZone(), Saturation(), CubicStiffness()))
    seen = {one.effect.kind: one.amplitude for one in found.visibility}
    assert seen["dead_zone"] is None
    assert seen["saturation"] is None
    assert seen["cubic_stiffness"] is not None
    assert all(one.judged for one in found.visibility)


def test_a_comparison_shows_the_error_of_the_simulation():
    """A model with a gain 5 % off fits 95 %, whatever a refit would bring."""
    g = np.random.default_rng(4)
    signals = white(g, SAMPLES)
    inputs, outputs = integrated(played(signals), SAMPLES)
    found = compare(model(), gather(records(inputs, 1.05 * outputs, 1e-4, g)))
    assert found.fit_percent == pytest.approx(95.2, abs=0.6)
    assert found.overall.p_value < 1e-6


def test_noise_that_is_coloured_keeps_the_size_of_the_test():
    small = []
    for seed in range(8):
        g = np.random.default_rng(seed)
        signals = white(g, SAMPLES)
        inputs, outputs = integrated(played(signals), SAMPLES)
        e = 0.02 * np.std(outputs) * g.standard_normal(outputs.shape)
        for t in range(1, SAMPLES):
            e[:, t] += 0.9 * e[:, t - 1]
        rows = rows_of(model(), gather(records(inputs, outputs + e, 0.0, g)))
        small.append(misfit("lack of fit", fit(model(), rows)).p_value)
    assert min(small) > 0.001
    assert np.mean(small) > 0.15
