"""Models to python-control and back, compared by their responses."""

import control
import numpy as np
import pytest

from identification.errors import MisuseError, RangeError
from identification.exports.control_objects import from_transfer_function, to_transfer_function
from identification.models.rational import RationalStructure

CASES = [
    (RationalStructure(2, 1, 1, sample_time=0.1), [-1.2, 0.5, 1.0, 0.4]),
    (RationalStructure(1, 2, 2, sample_time=0.5), [-0.4, 1.0, 0.4, -0.2]),
    (RationalStructure(1, 0, 0, 1, 1, sample_time=1.0), [-0.9, 2.0, 0.3, -0.5]),
    (RationalStructure(2, 1, frequency_scale=50.0), [0.8, 1.0, 0.5, 2.0]),
    (RationalStructure(1, 2, frequency_scale=3.0), [0.8, 1.0, 0.5, 2.0]),
]


@pytest.mark.parametrize(("structure", "zeta"), CASES)
def test_there_and_back(structure: RationalStructure, zeta: list[float]) -> None:
    omega = np.linspace(0.1, 3.0, 7) / (structure.sample_time or 1 / structure.frequency_scale)
    expected = structure.plant_response(np.array(zeta), omega)
    system = to_transfer_function(structure, np.array(zeta))
    axis = np.exp(1j * omega * structure.sample_time) if structure.sample_time else 1j * omega
    assert system(axis) == pytest.approx(expected, rel=1e-10)
    other, other_zeta = from_transfer_function(system)
    assert other.plant_response(other_zeta, omega) == pytest.approx(expected, rel=1e-10)
    assert other.sample_time == structure.sample_time


def test_what_is_no_rational_model() -> None:
    with pytest.raises(MisuseError, match="delay"):
        to_transfer_function(RationalStructure(1, 0, delay=True), np.array([1.0, 1.0, 0.1]))
    with pytest.raises(MisuseError, match="one input"):
        from_transfer_function(control.tf([[[1.0], [1.0]]], [[[1.0, 2.0], [1.0, 3.0]]]))
    with pytest.raises(MisuseError, match="sample time"):
        from_transfer_function(control.tf([1.0], [1.0, 0.5], True))
    with pytest.raises(RangeError, match="looks ahead"):
        from_transfer_function(control.tf([1.0, 0.0, 0.0], [1.0, 0.5], 0.1))
