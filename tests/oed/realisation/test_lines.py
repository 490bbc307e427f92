"""Lines of periodic signals: amplitudes from energies and back, and what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from identification.errors import MisuseError, RangeError, ShapeError
from oed.realisation import signal_line_energies
from oed.realisation.lines import designed_lines


@settings(deadline=None)
@given(st.integers(1, 65), st.integers(0, 2**32 - 1))
def test_the_energies_of_the_lines_are_the_energy_of_the_signal(samples: int, seed: int) -> None:
    signal = np.random.default_rng(seed).standard_normal(samples)
    energies = signal_line_energies(signal)
    assert energies.shape == (samples // 2 + 1,)
    assert np.sum(energies) == pytest.approx(np.sum(signal**2), rel=1e-12)


@settings(deadline=None)
@given(st.integers(2, 64), st.integers(0, 2**32 - 1))
def test_a_line_has_its_energy_whatever_the_phases(samples: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    index = np.flatnonzero(random.random(samples // 2 + 1) < 0.7)
    index = index if index.size else np.array([0])
    energies = random.uniform(0.1, 10.0, index.size)
    lines = designed_lines(index, energies, samples)
    signal = lines.signal(random.uniform(0.0, 2.0 * np.pi, index.size))
    assert signal_line_energies(signal)[index] == pytest.approx(energies, rel=1e-12)
    assert lines.rms == pytest.approx(np.sqrt(np.mean(signal**2)), rel=1e-12)


def test_a_cosine_is_the_cosine_of_the_definition() -> None:
    signal = designed_lines([3], [50.0], 100).signal(np.array([0.7]))
    assert signal == pytest.approx(np.cos(2.0 * np.pi * 3 * np.arange(100) / 100 + 0.7))


def test_the_same_phases_on_a_finer_grid_are_the_same_signal_between_its_samples() -> None:
    lines = designed_lines([0, 2, 7], [1.0, 2.0, 3.0], 20)
    phases = np.array([0.0, 1.0, 2.0])
    assert lines.signal(phases, 60)[::3] == pytest.approx(lines.signal(phases))


def test_lines_without_energy_are_left_out() -> None:
    lines = designed_lines([1, 2, 3], [1.0, 0.0, 2.0], 16)
    assert list(lines.indices) == [1, 3]


def test_a_common_divisor_shortens_the_period() -> None:
    lines = designed_lines([6, 12, 24], [1.0, 2.0, 1.0], 48)
    phases = np.array([0.3, 0.0, 0.0])
    assert lines.shortened().samples == 8
    assert np.tile(lines.shortened().signal(phases), 6) == pytest.approx(lines.signal(phases))


@pytest.mark.parametrize(
    ("indices", "energies", "samples", "error", "says"),
    [
        ([1, 2], [1.0], 16, ShapeError, "one energy for each line"),
        ([[1]], [[1.0]], 16, ShapeError, "one energy for each line"),
        ([1.5], [1.0], 16, MisuseError, "integers"),
        ([1], [-1.0], 16, RangeError, "not an energy"),
        ([1], [np.nan], 16, RangeError, "not an energy"),
        ([1], [np.inf], 16, RangeError, "not an energy"),
        ([1], [0.0], 16, RangeError, "no energy"),
        ([], [], 16, RangeError, "no energy"),
        ([9], [1.0], 16, RangeError, "at least 18 samples"),
        ([-1], [1.0], 16, RangeError, "negative"),
        ([2, 2], [1.0, 1.0], 16, RangeError, "twice"),
        ([0], [1.0], 0, RangeError, "at least one sample"),
    ],
)
def test_misuse_says_what_to_change(
    indices: list[int], energies: list[float], samples: int, error: type[MisuseError], says: str
) -> None:
    with pytest.raises(error, match=says) as caught:
        designed_lines(indices, energies, samples)
    assert caught.value.field in {"indices", "energies", "samples"}


def test_the_lines_of_no_signal_are_refused() -> None:
    with pytest.raises(ShapeError):
        signal_line_energies(np.zeros((2, 3)))
