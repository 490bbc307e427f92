"""The test keeps its level on spectra that are no chains of relaxations, and notices what breaks the relations."""

import numpy as np
import pytest

from identification.errors import MisuseError
from identification.measurements.kramers_kronig import linear_kramers_kronig
from identification.signals import FrequencyResponse

OMEGA = 2 * np.pi * np.geomspace(0.01, 1e4, 61)
NOISE = 0.002


def cell(omega: np.ndarray = OMEGA) -> np.ndarray:
    """A wire, an electrolyte, a depressed arc and diffusion into an electrode of finite thickness."""
    s = 1j * omega
    diffusion = 0.03 / np.sqrt(40 * s) / np.tanh(np.sqrt(40 * s))
    return np.asarray(2e-7 * s + 0.02 + 0.015 / (1 + (0.03 * s) ** 0.78) + diffusion)


def measured(z: np.ndarray, seed: int, degrees: float | None = None, omega: np.ndarray = OMEGA) -> FrequencyResponse:
    generator = np.random.default_rng(seed)
    sigma = NOISE * abs(z)
    noise = sigma * (generator.standard_normal(z.shape) + 1j * generator.standard_normal(z.shape)) / np.sqrt(2)
    variance = sigma**2
    if degrees is not None:
        variance = variance * generator.chisquare(2 * degrees, z.shape) / (2 * degrees)
    return FrequencyResponse(omega, z + noise, (25.0,), None, variance, degrees)


@pytest.mark.parametrize("degrees", [None, 8.0, 30.0])
def test_p_values_of_valid_impedances_are_uniform(degrees: float | None) -> None:
    found = [linear_kramers_kronig(measured(cell(), seed, degrees)).p_value for seed in range(400)]
    values = np.array(found, dtype=float)
    for level in (0.05, 0.3, 0.7):
        assert abs((values < level).mean() - level) < 4 * np.sqrt(level * (1 - level) / 400) + 0.01


def drifting() -> np.ndarray:
    """The cell warms up while the sweep goes down: its resistance falls, its phase does not know."""
    return np.asarray(cell().real * (1 + 0.03 * np.linspace(0, 1, len(OMEGA)) ** 3) + 1j * cell().imag)


@pytest.mark.parametrize(
    "broken",
    [
        drifting(),
        cell().conj(),
        cell() * np.where(np.arange(len(OMEGA)) < 30, 1.0, 1.02),  # the range of the instrument changed
        cell() + 0.001j,  # an offset of the imaginary part
    ],
)
def test_what_breaks_the_relations_is_noticed(broken: np.ndarray) -> None:
    assert all((linear_kramers_kronig(measured(broken, seed)).p_value or 0.0) < 1e-3 for seed in range(10))


def test_a_wrong_sign_is_told_from_other_faults() -> None:
    wrong, right = (linear_kramers_kronig(measured(z, 1)) for z in (cell().conj(), cell()))
    assert wrong.conjugate_size < 0.1 * wrong.size
    assert right.size < 0.1 * right.conjugate_size
    assert right.size == pytest.approx(NOISE, rel=0.3)


def test_without_variance_there_is_a_size_and_no_verdict() -> None:
    found = linear_kramers_kronig(FrequencyResponse(OMEGA, cell(), (25.0,)))
    assert found.p_value is None
    assert found.size < 1e-4
    few_repeats = linear_kramers_kronig(measured(cell(), 2, degrees=2.0))
    assert few_repeats.p_value is None


def test_what_cannot_be_tested_is_refused() -> None:
    with pytest.raises(MisuseError, match="10 frequencies"):
        linear_kramers_kronig(FrequencyResponse(OMEGA[:9], cell()[:9], (25.0,)))
    with pytest.raises(MisuseError, match="one channel"):
        linear_kramers_kronig(FrequencyResponse(OMEGA, np.ones((61, 2, 2)) + 0j, (25.0,)))
