"""The missing law: found as a curve where no name fits, after every name, with its size by restricted likelihood."""

import dataclasses

import numpy as np
import pytest

from identification.channels import Channel, Channels
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose, rows_of
from identification.diagnosis.missing_law import fitted_law
from identification.diagnosis.penalised import CurveTest
from identification.diagnosis.scores import score_tests
from identification.diagnosis.signatures import candidates, tangent_space
from identification.diagnosis.staircase import conclusion, relative_error, staircase
from identification.effects.law import Law
from identification.effects.library import library
from identification.extension.fit import fit
from identification.extension.rows import Rows, effect_tangents
from tests.support.oscillators import (
    LINES,
    MODEL,
    OMEGA,
    PERIOD,
    POINTS,
    SAMPLE_TIME,
    batches,
    integrated,
    phasors,
    played,
    records,
)

SIGMA = 1e-3
POSITION = Channels(Channel("u", "force", "N"), Channel("y", "position", "m"))
MECHANICAL = [one for one in library("mechanical") if one.kind not in ("two_mass", "hysteresis")]


def measured(force, seed=3, level=8.0, sigma=SIGMA, points=POINTS, gain=lambda u: u, channels=POSITION):
    g = np.random.default_rng(seed)
    inputs = [phasors(g, level) for _ in points]
    outputs = [(a, integrated(p, a, force, gain)) for p, a in zip(points, inputs, strict=True)]
    found = records(outputs, g, sigma, points=points)
    return gather([dataclasses.replace(one, channels=channels) for one in found])


def of(found):
    law = found.best.fit.model.effects[-1]
    return law.effect, law.effect.curve(law.coefficients[:, 0])


def left_of(curve, truth, x):
    """How far the curve is from the truth beyond straight lines, as a share of that."""
    straight = np.stack([np.ones_like(x), x], axis=1)
    off, size = (y - straight @ np.linalg.lstsq(straight, y, rcond=None)[0] for y in (curve - truth, truth))
    return np.linalg.norm(off) / np.linalg.norm(size)


@pytest.mark.parametrize(
    ("force", "over", "accuracy"),
    [
        (lambda x, v: 300.0 * x**5, "displacement", 0.05),
        (lambda x, v: 12.0 * x * np.exp(-((x / 0.25) ** 2)), "displacement", 0.1),
        (lambda x, v: 3.0 * (np.exp(1.5 * x) - 1), "displacement", 0.02),
        (lambda x, v: 3.0 * np.exp(-(((v - 1.0) / 0.9) ** 2)), "flow", 0.25),
    ],
    ids=["quintic", "soft in the middle", "exponential", "a bump over speed"],
)
def test_what_has_no_name_is_found_as_a_curve(force, over, accuracy):
    """Against an adaptive integrator: the curve is the law, its sign included."""
    found = diagnose(MODEL, measured(force), MECHANICAL)
    assert found.announced[0].score.candidate.effect.kind == "law"
    assert found.verdict in ("explained", "partly explained")
    assert not found.confident
    assert "no effect of the library has this shape" in found.reason
    law, curve = of(found)
    assert law.over == over
    x = np.linspace(law.knots[2], law.knots[-3], 60)
    assert left_of(curve.each(x).T @ curve.coefficients, force(x, x), x) < accuracy


def test_the_law_is_added_and_the_error_on_other_data_falls():
    force = lambda x, v: 3.0 * (np.exp(1.5 * x) - 1)  # noqa: E731
    data, other = measured(force), measured(force, seed=8, sigma=1e-6, points=(-0.7, 0.2, 0.8), level=7.0)
    effects = [one for one in MECHANICAL if one.kind in ("cubic_stiffness", "quadratic_stiffness", "law", "delay")]
    steps = staircase(MODEL, data, other, effects=effects)
    assert [one.effect.kind for one in steps[-1].model.effects] == ["law"]
    assert conclusion(steps) == "explained"
    assert steps[-1].held_out_error < 0.02 * steps[0].held_out_error
    assert relative_error(steps[-1].model, other) == steps[-1].held_out_error
    assert steps[-1].model.joint_covariance is not None


@pytest.mark.parametrize(
    ("force", "kind"),
    [
        (lambda x, v: 60.0 * x**3, "cubic_stiffness"),
        (lambda x, v: 1.0 * abs(v) * v, "quadratic_damping"),
        (lambda x, v: 2.0 * np.tanh(v / 1e-3), "coulomb_friction"),
    ],
)
def test_a_name_that_is_right_stands_before_the_curve(force, kind):
    found = diagnose(MODEL, measured(force), MECHANICAL)
    assert found.announced[0].score.candidate.effect.kind == kind
    assert found.confident
    assert not found.behaves


def test_a_name_that_fits_no_better_than_a_curve_is_a_likeness():
    """An even power between two and four, small: a square imitates it about as well as a curve of any shape."""
    data = measured(lambda x, v: 4.0 * abs(x) ** 2.2, sigma=0.026)
    found = diagnose(MODEL, data, [one for one in MECHANICAL if one.kind in ("quadratic_stiffness", "law")])
    assert found.announced[0].score.candidate.effect.kind == "quadratic_stiffness"
    assert found.behaves
    assert not found.confident
    assert found.reason.startswith("it behaves like ")


def test_a_coefficient_of_another_shape_over_p_is_a_curve_over_p():
    points = tuple(np.linspace(-1, 1, 9))
    g = np.random.default_rng(5)
    stiffness = lambda p: 30 + 10 * p + 6 * np.exp(-(((p - 0.3) / 0.3) ** 2))  # noqa: E731

    def answer(p, a):
        return played(a / (stiffness(p) - OMEGA**2 + 1.5j * OMEGA), np.arange(PERIOD) * SAMPLE_TIME)

    inputs = [phasors(g) for _ in points]
    data = gather(records([(a, answer(p, a)) for p, a in zip(points, inputs, strict=True)], g, SIGMA, points=points))
    effects = [one for one in library() if one.kind in ("law", "quadratic_dependence", "cubic_dependence", "low_basis")]
    found = diagnose(MODEL, data, effects)
    law, curve = of(found)
    assert (law.over, law.coefficient) == ("scheduling", 1)
    p = np.array(points)
    assert left_of(curve(p), stiffness(p), p) < 0.15


def test_the_likelihood_ratio_is_that_of_dense_matrices():
    """−2 ln of the restricted likelihood of N(0, 1 + τ² U Uᵀ) off θ and the constant, by determinants."""
    (batch,) = batches(4, 1e-2)
    rows = Rows((dataclasses.replace(batch, ends=None, nuisance=None),))
    base = fit(MODEL, rows)
    (candidate,) = candidates(base, [Law()])
    signature = candidate.signatures[0]
    law = signature.placed.effect
    test = CurveTest.of(signature)
    tangents = effect_tangents(signature.placed, rows, base.flows)
    fixed = np.concatenate([tangent_space(base), tangents[:1]])
    u = tangents[1:]
    r = np.random.default_rng(0).standard_normal(u.shape[1]) + 0.3 * u.T @ np.ones(len(u)) / np.linalg.norm(u)

    def minus_two_log(tau):
        v = np.eye(u.shape[1]) + tau**2 * u.T @ u
        inverse = np.linalg.inv(v)
        information = fixed @ inverse @ fixed.T
        projected = inverse - inverse @ fixed.T @ np.linalg.solve(information, fixed @ inverse)
        return np.linalg.slogdet(v)[1] + np.linalg.slogdet(information)[1] + r @ projected @ r

    ratio, tau = test.size(signature.basis @ r)
    assert law.precision()[1:] == pytest.approx(1.0)
    assert ratio == pytest.approx(minus_two_log(0.0) - minus_two_log(tau), rel=1e-4)
    assert ratio >= minus_two_log(0.0) - min(minus_two_log(f * tau) for f in (0.5, 2.0)) - 1e-6


def test_nothing_missing_is_seldom_a_curve():
    """Of 100 draws of noise about as many are below a level as it says."""
    (batch,) = batches(4, 1e-2)
    base = fit(MODEL, Rows((batch,)))
    seen = [one for one in candidates(base, [Law()]) if one.signatures]
    g = np.random.default_rng(7)
    space = tangent_space(base)
    p = []
    for _ in range(100):
        noise = g.standard_normal(len(base.residual))
        trial = dataclasses.replace(base, residual=noise - (space @ noise) @ space)
        p.append(score_tests(trial, seen, np.random.default_rng(0))[0].adjusted_p)
    assert 0.0 < np.mean(np.array(p) < 0.05) < 0.1
    assert 0.35 < np.mean(np.array(p) < 0.5) < 0.65


def test_the_band_covers_the_curve():
    """Of six laws of one kind with other noise, the 95 % band holds the curve in about that many places."""
    force = lambda x, v: 100.0 * x**5  # noqa: E731
    inside = []
    g = np.random.default_rng(3)
    inputs = [phasors(g, 8.0) for _ in POINTS]
    clean = [(a, integrated(p, a, force)) for p, a in zip(POINTS, inputs, strict=True)]
    for seed in range(6):
        data = gather(
            [dataclasses.replace(one, channels=POSITION) for one in records(clean, np.random.default_rng(seed), 5e-3)]
        )
        base = fit(MODEL, rows_of(MODEL, data))
        (candidate,) = candidates(base, [Law()])
        (score,) = score_tests(base, [candidate], np.random.default_rng(0))
        found = fitted_law(base, score)
        one, p = found.placed, found.fit.model.joint_covariance
        x = np.linspace(one.effect.knots[2], one.effect.knots[-3], 20)
        shapes = one.effect.curve(one.coefficients[:, 0]).each(x)
        own = p[-one.size :, -one.size :]
        straight = np.stack([np.ones_like(x), x], axis=1)
        off_lines = np.eye(len(x)) - straight @ np.linalg.pinv(straight)
        off = off_lines @ (one.coefficients[:, 0] @ shapes - force(x, x))
        band = np.sqrt(np.diag(off_lines @ shapes.T @ own @ shapes @ off_lines))
        inside += list(abs(off) < 1.96 * band)
    assert np.mean(inside) > 0.85
    assert len(LINES) == 10
