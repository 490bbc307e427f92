"""The motion between samples, against an integration in small steps that knows nothing of logarithms."""

import numpy as np
import pytest
from scipy.signal import dlsim, ss2tf

from identification.models.rational import RationalStructure
from identification.places.intersample import OFFSETS, between_samples

STEP, FINE = 0.05, 320


def integrated(acceleration, start, u):
    """Position and velocity (L, FINE) of ẍ = a(x, ẋ, u) with u held, by the classical Runge–Kutta method."""
    h, (x, v) = STEP / FINE, start
    found = np.empty((len(u), FINE, 2))

    def slope(w, force):
        return np.array([w[1], acceleration(w[0], w[1], force)])

    w = np.array([x, v], dtype=float)
    for k, force in enumerate(u):
        for j in range(FINE):
            found[k, j] = w
            one = slope(w, force)
            two = slope(w + h / 2 * one, force)
            three = slope(w + h / 2 * two, force)
            w = w + h / 6 * (one + 2 * two + 2 * three + slope(w + h * three, force))
    return found[..., 0], found[..., 1]


def sampled(stiffness, damping):
    """The plant ẍ = −c ẋ − k x + 2 u as SciPy samples it."""
    from scipy.signal import cont2discrete

    matrices = np.array([[0, 1], [-stiffness, -damping]]), np.array([[0], [2.0]]), np.eye(1, 2), np.zeros((1, 1))
    a, b, c, d, _ = cont2discrete(matrices, STEP)
    b_of_z, a_of_z = ss2tf(a, b, c, d)
    return np.concatenate([a_of_z[1:], b_of_z[0, 1:]]), (a, b, c, d)


@pytest.mark.parametrize(("stiffness", "damping"), [(30.0, 0.8), (30.0, 30.0), (0.0, 2.0), (-3.0, 0.5)])
def test_position_and_velocity_between_samples(stiffness, damping):
    zeta, _ = sampled(stiffness, damping)
    u = np.random.default_rng(1).standard_normal(40)
    x, v = integrated(lambda x, v, f: 2 * f - damping * v - stiffness * x, (0.3, -1.0), u)
    structure = RationalStructure(2, 1, 1, sample_time=STEP)
    found = between_samples(structure, zeta[None], STEP, x[None, :, 0], u[None], repeats=False)
    assert found is not None
    middles = slice(FINE // OFFSETS // 2, None, FINE // OFFSETS)
    assert np.allclose(found[0][0], x[:, middles].ravel(), atol=1e-7 * abs(x).max())
    assert np.allclose(found[1][0], v[:, middles].ravel(), atol=1e-6 * abs(v).max())


def test_signals_that_repeat_are_followed_around_their_end():
    zeta, system = sampled(30.0, 3.0)
    u = np.tile(np.random.default_rng(2).standard_normal(24), 8)
    x = dlsim((*system, STEP), u)[1][:, 0]
    structure = RationalStructure(2, 1, 1, sample_time=STEP)
    last, before = (between_samples(structure, zeta[None], STEP, x[None, k : k + 24], u[None, :24]) for k in (168, 167))
    assert last is not None
    assert before is not None
    whole = between_samples(structure, zeta[None], STEP, x[None], u[None], repeats=False)
    assert whole is not None
    assert np.allclose(last[1][0], whole[1][0, 168 * OFFSETS :], atol=1e-6 * abs(whole[1]).max())
    assert not np.allclose(before[1][0], whole[1][0, 168 * OFFSETS :], atol=1e-2 * abs(whole[1]).max())


@pytest.mark.parametrize(
    "structure", [RationalStructure(1, 0, 0, sample_time=1.0), RationalStructure(1, 0, 2, sample_time=1.0)]
)
def test_no_motion_is_made_up_where_the_samples_do_not_give_one(structure):
    assert between_samples(structure, np.array([[-0.5, 1.0]]), 1.0, np.zeros((1, 8)), np.zeros((1, 8))) is None


def test_a_pole_left_of_zero_has_no_motion():
    structure = RationalStructure(1, 0, 1, sample_time=1.0)
    assert between_samples(structure, np.array([[0.5, 1.0]]), 1.0, np.zeros((1, 8)), np.zeros((1, 8))) is None
