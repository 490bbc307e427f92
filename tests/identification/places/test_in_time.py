"""Linear recursions that vary, and loops linearised on a time grid, against the same solved otherwise."""

import numpy as np
import pytest

from identification.models.physical import Coefficient, PhysicalForm
from identification.models.rational import RationalStructure
from identification.places.in_time import LinearisedInTime, plants_in_time
from identification.places.scan import Recursion

OSCILLATOR = RationalStructure(2, 0), np.array([[2.0, 50.0, 3.0], [1.0, 90.0, 1.0]])


@pytest.mark.parametrize("length", [1, 8, 64, 256])
def test_a_recursion_over_a_period_closes(length):
    g = np.random.default_rng(length)
    steps, driven = 0.4 * g.normal(size=(3, 3, 2, length)), g.normal(size=(3, 4, 2, length))
    states = Recursion(steps).states(driven)
    following = np.einsum("ijmk,jcmk->icmk", steps, states) + driven
    assert following == pytest.approx(np.roll(states, -1, axis=-1), abs=1e-9)


def test_steps_that_are_not_finite_are_no_error():
    steps = np.ones((1, 1, 1, 4))
    steps[..., 2] = np.inf
    with np.errstate(all="ignore"):
        Recursion(steps).states(np.ones((1, 1, 4)))


@pytest.mark.parametrize(
    ("structure", "zeta", "order"),
    [
        (OSCILLATOR[0], OSCILLATOR[1][0], 0),
        (RationalStructure(2, 1, frequency_scale=7.0), np.array([0.3, 1.2, 0.4, 0.1]), 0),
        (RationalStructure(2, 1), np.array([2.0, 50.0, 3.0, 4.0]), 1),
        (RationalStructure(2, 2), np.array([2.0, 50.0, 3.0, 4.0, 1.0]), 1),
        (RationalStructure(2, 2, frequency_scale=5.0), np.array([2.0, 50.0, 3.0, 4.0, 1.0]), 2),
        (RationalStructure(3, 1), np.array([2.0, 50.0, 40.0, 3.0, 4.0]), 2),
        (PhysicalForm((Coefficient("J"), Coefficient("d")), (Coefficient("k", fixed=2.0),)), np.array([0.5, 0.7]), 1),
    ],
)
def test_plants_move_as_the_structure_says(structure, zeta, order):
    """C (jωI − A)⁻¹ B + D against (jω)^−d G and (jω)^(1−d) G."""
    found = plants_in_time(structure, zeta[None], 0.01, 1, 10**8, order)
    omega = np.array([0.5, 3.0, 20.0])
    wanted = structure.plant_response(zeta, omega)
    a, b, c, d = (part[..., 0] for part in (found.generator, found.entry, found.motion, found.direct))
    for k, w in enumerate(omega):
        seen = c @ np.linalg.solve(1j * w * np.eye(len(a)) - a, b) + d
        assert seen == pytest.approx(wanted[k] * (1j * w) ** np.array([-order, 1 - order]), rel=1e-5)


def test_a_sampled_plant_is_the_one_between_its_samples():
    """With poles −1 ± 7j and a force held over samples, from the plant in continuous time and from its samples."""
    alone = plants_in_time(OSCILLATOR[0], OSCILLATOR[1][:1], 0.02, 4, 10**8, 0)
    matrix, output = OSCILLATOR[0].sampled(OSCILLATOR[1][0], 0.02)
    characteristic = np.poly(matrix[:2, :2])
    markov = [output @ np.linalg.matrix_power(matrix[:2, :2], i) @ matrix[:2, 2] for i in range(2)]
    structure = RationalStructure(2, 1, 1, sample_time=0.02)
    zeta = np.array([[*characteristic[1:], markov[0], markov[1] + characteristic[1] * markov[0]]])
    found = plants_in_time(structure, zeta, 0.02, 4, 10**8, 0)
    assert _pushed(found) == pytest.approx(_pushed(alone), rel=1e-6)


def _pushed(plants):
    """Displacement and flow of the first plant after each of twelve equal pushes."""
    states, seen = np.zeros(2), []
    for _ in range(12):
        states = plants.transition[..., 0] @ states + 0.005 * plants.entry[:, 0]
        seen.append(plants.motion[..., 0] @ states)
    return np.array(seen)


@pytest.mark.parametrize("springs", [True, False])
def test_forces_react_to_the_motion_that_they_make(springs):
    """φ of slopes that vary over a period, against the same loop written out as one system of equations."""
    g, length, h = np.random.default_rng(3), 48, 0.02
    plants = plants_in_time(*OSCILLATOR, h, 1, length, 0)
    slopes = 5.0 * g.random((2, length)), 0.4 * g.random((2, length))
    by_q, by_flow = (slopes[0], np.zeros((2, length))) if springs else (np.zeros((2, length)), slopes[1])
    unyielding = g.normal(size=(2, length))
    found = LinearisedInTime(plants, by_q, by_flow).force(unyielding)
    for m in range(2):
        transition, entry, motion = (part[..., m] for part in (plants.transition, plants.entry, plants.motion))
        closed = np.linalg.inv(np.eye(2) - np.linalg.matrix_power(transition, length))
        moved = np.empty((2, length, length))
        for lag in range(length):
            kicked = np.linalg.matrix_power(transition, lag if lag else length) @ closed @ entry
            kicked = kicked + (0.5 * entry if lag == 0 else 0.0)
            for k in range(length):
                moved[:, (k + lag) % length, k] = -h * motion @ kicked
        wanted = np.linalg.solve(
            np.eye(length) - by_q[m][:, None] * moved[0] - by_flow[m][:, None] * moved[1], unyielding[m]
        )
        assert found[m] == pytest.approx(wanted, rel=1e-6, abs=1e-9)
