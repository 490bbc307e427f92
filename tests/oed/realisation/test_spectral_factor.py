"""The minimum-phase filter reproduces the coefficients of its spectrum, also where the spectrum touches zero."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from identification.arrays import FloatArray
from identification.errors import RangeError, ShapeError
from oed.realisation import spectral_factor


def autocovariance(h: FloatArray) -> FloatArray:
    return np.asarray(np.correlate(h, h, "full")[len(h) - 1 :], dtype=np.float64)


def from_zeros(angles: FloatArray) -> FloatArray:
    """The filter with pairs of zeros on the unit circle."""
    h = np.ones(1)
    for angle in angles:
        h = np.convolve(h, [1.0, -2.0 * np.cos(angle), 1.0])
    return np.asarray(h / np.abs(h).max(), dtype=np.float64)


def assert_factor(c: FloatArray, accuracy: float = 1e-9) -> FloatArray:
    h = spectral_factor(c)
    assert autocovariance(h) == pytest.approx(c, abs=accuracy * c[0])
    assert np.sum(h**2) == pytest.approx(c[0], rel=1e-12)
    assert h[0] > 0.0
    return h


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 30), st.integers(0, 2**32 - 1), st.floats(1e-6, 1e6))
def test_random_spectra(degree: int, seed: int, scale: float) -> None:
    c = autocovariance(scale * np.random.default_rng(seed).standard_normal(degree + 1))
    h = assert_factor(c)
    assert np.all(np.abs(np.roots(h)) < 1.0 + 1e-7)


@settings(deadline=None, max_examples=40)
@given(st.lists(st.floats(0.0, np.pi), min_size=1, max_size=10))
def test_zeros_on_the_unit_circle(angles: list[float]) -> None:
    c = autocovariance(from_zeros(np.array(angles)))
    h = assert_factor(c)
    omega = np.linspace(0.0, np.pi, 200)
    density = c[0] + 2.0 * np.cos(np.outer(omega, np.arange(1, len(c)))) @ c[1:]
    achieved = np.abs(np.exp(-1j * np.outer(omega, np.arange(len(h)))) @ h) ** 2
    assert achieved == pytest.approx(density, abs=1e-8 * len(c) * c[0])


@pytest.mark.parametrize("degree", [1, 10, 100])
def test_a_filter_with_all_its_zeros_on_the_unit_circle(degree: int) -> None:
    h = assert_factor(autocovariance(np.ones(degree + 1)))
    assert h == pytest.approx(np.ones(degree + 1), abs=1e-4)


def test_a_minimum_phase_filter_is_found_again() -> None:
    h = np.asarray(np.poly([0.9, -0.5, 0.3 + 0.6j, 0.3 - 0.6j]).real, dtype=np.float64)
    assert assert_factor(autocovariance(h)) == pytest.approx(h, abs=1e-9)


def test_white_noise_has_one_coefficient() -> None:
    assert spectral_factor([9.0]) == pytest.approx([3.0])
    assert spectral_factor([9.0, 0.0, 0.0]) == pytest.approx([3.0, 0.0, 0.0])


@pytest.mark.parametrize("dip", [1e-12, 1e-9, 1e-7])
def test_a_spectrum_that_rounding_took_below_zero_is_lifted_by_as_much(dip: float) -> None:
    c = autocovariance(from_zeros(np.array([0.5, 1.1, 2.0])))
    c = c / c[0]
    c[0] -= dip
    assert_factor(c, 3.0 * dip + 1e-11)


def test_a_spectrum_that_is_negative_is_refused_and_it_is_said_where() -> None:
    with pytest.raises(RangeError, match=r"negative .* ω = 3\.14"):
        spectral_factor([1.0, 0.6])


def test_misuse_is_refused() -> None:
    with pytest.raises(RangeError, match="not a finite number"):
        spectral_factor([1.0, np.nan])
    with pytest.raises(RangeError, match="must be positive"):
        spectral_factor([0.0, 0.0])
    for wrong in ([], [[1.0]]):
        with pytest.raises(ShapeError, match="one row"):
            spectral_factor(wrong)
