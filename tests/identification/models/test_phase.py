"""The phase is that of the poles, zeros and delays themselves, whatever the grid."""

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.effects.delay import Delay
from identification.extension.response import response_phase
from identification.models.model import Model
from identification.models.phase import continuous_phase
from identification.models.physical import Coefficient, PhysicalForm
from identification.models.rational import RationalStructure
from identification.models.state_space import StateSpaceStructure
from identification.places.placed import placed
from identification.scheduling import ProductBasis, SchedulingVariable

COARSE = np.array([0.0, 0.3, 2.0, 9.0, 29.0])
VARIABLES = (SchedulingVariable("p", "", 0.0, 1.0),)
CONSTANT = ProductBasis((Polynomial(0),))


def model(structure: RationalStructure | PhysicalForm, zeta: list[float]) -> Model:
    return Model(structure, structure.over(VARIABLES, CONSTANT), np.array(zeta), np.eye(len(zeta)), 1.0)


def phase(of: Model, omega: np.ndarray) -> np.ndarray:
    return response_phase(of, [0.5], omega)


def test_a_continuous_delay_is_counted_in_full() -> None:
    of = model(RationalStructure(1, 0, delay=True), [1.0, 1.0, 3.0])
    np.testing.assert_allclose(phase(of, COARSE), -np.arctan(COARSE) - 3 * COARSE, atol=1e-9)


def test_the_order_of_the_frequencies_does_not_matter() -> None:
    of = model(RationalStructure(1, 0, delay=True), [1.0, 1.0, 3.0])
    np.testing.assert_allclose(phase(of, COARSE[::-1])[::-1], phase(of, COARSE))


def test_samples_of_delay_are_counted_in_full() -> None:
    of = model(RationalStructure(1, 0, 40, sample_time=0.1), [-0.9, 0.1])
    lag = np.angle(0.1 / (1 - 0.9 * np.exp(-0.1j * COARSE)))
    np.testing.assert_allclose(phase(of, COARSE), lag - 4.0 * COARSE, atol=1e-9)


def test_a_delay_of_the_physical_form_and_one_found_later_add_up() -> None:
    form = PhysicalForm((Coefficient("J"), Coefficient("d")), (Coefficient("k", "", 1.0),), delay=True)
    of = model(form, [1.0, 1.0, 2.0]).plus(placed(Delay(), 0, 1, 1.0))
    np.testing.assert_allclose(phase(of, COARSE), -np.arctan(COARSE) - 3 * COARSE, atol=1e-9)


@pytest.mark.parametrize("damping", [0.002, 1e-6])
def test_weakly_damped_poles_between_two_frequencies_turn_by_half_a_turn_each(damping: float) -> None:
    poles = [-damping + 1j * w for w in (1, -1, 4, -4, 5, -5)]
    of = model(RationalStructure(6, 0), [*np.poly(poles)[1:].real, 1.0])
    assert phase(of, COARSE) == pytest.approx([0.0, 0.0, -np.pi, -3 * np.pi, -3 * np.pi], abs=0.01)


def test_poles_at_zero_of_a_state_space_delay_too() -> None:
    n, step = 30, 0.2
    omega = np.array([0.1, 5.0, 15.0])
    memory = StateSpaceStructure(n, sample_time=step).memory
    found = continuous_phase(lambda w: np.exp(-1j * w * step * n), omega, memory=memory)
    np.testing.assert_allclose(found - found[0], -n * step * (omega - omega[0]), atol=1e-9)
