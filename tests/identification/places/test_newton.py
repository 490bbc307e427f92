"""Newton's method where mixing of steps gives up."""

import numpy as np
import pytest

from identification.arrays import ComplexArray
from identification.places.newton import newton
from identification.places.simulate import LIMIT, NoSteadyStateError, fixed_point

DRIVE = np.fft.rfft(np.cos(2 * np.pi * np.arange(16) / 16))
LAG = 1 / (1 + 1j * np.arange(9))


def hardening(x: ComplexArray) -> ComplexArray:
    """A lag with a force that grows with the cube of its output."""
    return np.asarray(LAG * (DRIVE - 40 * np.fft.rfft(np.fft.irfft(x, n=16) ** 3)))


def test_it_goes_on_where_mixing_gives_up() -> None:
    start = (LAG * DRIVE)[None]
    with pytest.raises(NoSteadyStateError):
        fixed_point(hardening, start)
    found = newton(hardening, start, LIMIT)
    np.testing.assert_allclose(found, hardening(found), atol=1e-7)
    assert np.linalg.norm(found) < 0.6 * np.linalg.norm(start)


def test_it_says_when_there_is_none() -> None:
    with pytest.raises(NoSteadyStateError):
        newton(lambda x: x + 1, np.ones((1, 3), dtype=complex), LIMIT)
