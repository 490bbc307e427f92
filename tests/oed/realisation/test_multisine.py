"""Multisines have exactly the designed lines, and a lower peak than any of a thousand random draws of phases."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from identification.arrays import FloatArray, IntArray
from identification.errors import RangeError, ShapeError
from oed.realisation import crest_factor, multisine, signal_line_energies
from oed.realisation.descent import clipped, log_norm, norm_descent, schroeder_phases
from oed.realisation.lines import Lines, designed_lines
from oed.realisation.minimax import polished
from oed.realisation.multisine import interpolated

FLAT = {
    "1..20 of 256": (np.arange(1, 21), 256),
    "1..20 of 997": (np.arange(1, 21), 997),
    "0..20 of 1000": (np.arange(21), 1000),
    "odd ones below 40 of 1000": (np.arange(1, 40, 2), 1000),
    "5, 10 … 100 of 1000": (np.arange(5, 101, 5), 1000),
    "all of 64": (np.arange(33), 64),
    "1..100 of 400": (np.arange(1, 101), 400),
    "1..1000 of 4096": (np.arange(1, 1001), 4096),
}


def design(seed: int) -> tuple[IntArray, FloatArray, int]:
    """A design drawn at random: few or many lines, spread or together, with and without ω = 0 and Nyquist."""
    random = np.random.default_rng(seed)
    samples = int(random.choice([5, 8, 16, 31, 100, 128, 256, 500]))
    most = samples // 2 + 1
    count = min(most, int(random.choice([1, 2, 3, 4, 6, 10, 15])))
    if random.random() < 0.5:
        index = np.sort(random.choice(most, count, replace=False))
    else:
        index = random.integers(0, most - count + 1) + np.arange(count)
    return index, 10.0 ** random.uniform(-random.choice([0.0, 1.0, 4.0]), 0.0, count), samples


def peaks_of_random_phases(lines: Lines, seed: int, count: int = 1000) -> FloatArray:
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, (count, len(lines.indices)))
    peaks: FloatArray = np.abs(lines.signal(phases)).max(axis=-1)
    return peaks


@pytest.mark.parametrize("seed", range(40))
def test_lines_are_exact_and_the_peak_is_below_a_thousand_random_draws(seed: int) -> None:
    index, energies, samples = design(seed)
    signal = multisine(index, energies, samples, np.random.default_rng(seed))
    achieved = signal_line_energies(signal)
    assert achieved[index] == pytest.approx(energies, rel=1e-10, abs=0.0)
    assert np.all(np.delete(achieved, index) <= 1e-28 * energies.sum())
    drawn = peaks_of_random_phases(designed_lines(index, energies, samples), seed + 1000)
    peak = np.abs(signal).max()
    if np.ptp(drawn) > 1e-12 * peak:
        assert peak < drawn.min()
    else:
        assert peak <= drawn.min() * (1.0 + 1e-12)


@pytest.mark.parametrize("name", FLAT)
def test_a_flat_multisine_has_a_crest_factor_of_one_and_a_half_at_most(name: str) -> None:
    index, samples = FLAT[name]
    signal = multisine(index, np.ones(len(index)), samples, 3)
    assert crest_factor(signal) <= 1.5
    assert signal_line_energies(signal)[index] == pytest.approx(np.ones(len(index)), rel=1e-10)


def test_two_lines_that_never_repeat_within_the_record_are_still_below_random_draws() -> None:
    index, energies = np.array([7, 8001]), np.array([1.0, 3.0])
    signal = multisine(index, energies, 20011, 0)
    drawn = peaks_of_random_phases(designed_lines(index, energies, 20011), 1, 30)
    assert np.abs(signal).max() < drawn.min()


@pytest.mark.parametrize(("samples", "index"), [(4, 1), (7, 1), (64, 6), (100, 7), (1000, 7), (1001, 7)])
def test_a_single_line_lies_with_its_peak_in_the_middle_between_samples(samples: int, index: int) -> None:
    distinct = samples // np.gcd(samples, index)
    apart = np.pi / distinct * (2 if distinct % 2 == 0 else 1)
    signal = multisine([index], [5.0], samples, 0)
    assert crest_factor(signal) == pytest.approx(np.sqrt(2.0) * np.cos(apart / 2.0), rel=1e-12)


@pytest.mark.parametrize(("index", "crest"), [([0], 1.0), ([8], 1.0), ([0, 8], np.sqrt(2.0))])
def test_lines_without_a_free_phase(index: list[int], crest: float) -> None:
    signal = multisine(index, np.full(len(index), 4.0), 16, 0)
    assert crest_factor(signal) == pytest.approx(crest)
    assert signal_line_energies(signal)[index] == pytest.approx(np.full(len(index), 4.0))


def test_the_same_generator_state_gives_the_same_signal_and_another_one_another() -> None:
    index, energies, samples = np.arange(1, 16), np.linspace(1.0, 2.0, 15), 128
    first = multisine(index, energies, samples, np.random.default_rng(5))
    assert first.tobytes() == multisine(index, energies, samples, 5).tobytes()
    assert first.tobytes() != multisine(index, energies, samples, 6).tobytes()


def test_oversampling_lowers_the_peak_between_the_samples() -> None:
    index, samples = np.arange(1, 41), 96
    of_samples = multisine(index, np.ones(40), samples, 0)
    of_between = multisine(index, np.ones(40), samples, 0, oversampling=8)
    assert crest_factor(of_between, 8) < 1.5 < crest_factor(of_samples, 8)
    assert crest_factor(of_samples) < crest_factor(of_between)
    assert signal_line_energies(of_between)[index] == pytest.approx(np.ones(40), rel=1e-10)


def test_oversampling_keeps_a_nyquist_line() -> None:
    signal = multisine([1, 3, 8], [1.0, 1.0, 2.0], 16, 0, oversampling=4)
    assert signal_line_energies(signal)[[1, 3, 8]] == pytest.approx([1.0, 1.0, 2.0])


@pytest.mark.parametrize("samples", [15, 16])
@pytest.mark.parametrize("oversampling", [1, 2, 5])
def test_interpolation_keeps_the_samples(samples: int, oversampling: int) -> None:
    signal = np.random.default_rng(0).standard_normal(samples)
    assert interpolated(signal, oversampling)[::oversampling] == pytest.approx(signal)


def test_interpolation_shows_the_peak_of_a_sine_between_its_samples() -> None:
    signal = np.sin(2.0 * np.pi * np.arange(4) / 4 + np.pi / 4)
    assert crest_factor(signal) == pytest.approx(1.0)
    assert crest_factor(signal, 2) == pytest.approx(np.sqrt(2.0))


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**16), st.sampled_from([4, 16, 128]))
def test_the_gradient_of_the_norm_is_its_derivative(seed: int, p: int) -> None:
    index, energies, samples = design(seed)
    lines = designed_lines(index, energies, samples)
    random = np.random.default_rng(seed)
    phases, direction = random.uniform(0.0, 6.0, len(index)), random.standard_normal(len(index))
    direction *= lines.free
    step = 1e-5 / p
    up, down = (log_norm(phases + s * direction, lines, p, samples)[0] for s in (step, -step))
    slope = log_norm(phases, lines, p, samples)[1] @ direction
    assert (up - down) / (2.0 * step) == pytest.approx(slope, rel=1e-3, abs=1e-4)


def test_a_high_norm_is_the_peak() -> None:
    lines = designed_lines([1, 2, 5], [1.0, 2.0, 1.0], 64)
    phases = np.array([0.1, 0.2, 0.3])
    value, _ = log_norm(phases, lines, 4096, 64)
    assert np.exp(value) == pytest.approx(np.abs(lines.signal(phases)).max(), rel=2e-3)


def test_each_stage_lowers_the_peak() -> None:
    lines = designed_lines(np.arange(1, 31), np.linspace(1.0, 3.0, 30), 200)
    start = np.random.default_rng(2).uniform(0.0, 6.0, (1, 30))
    stages = [start[0], clipped(lines, start, 200)[0]]
    stages.append(norm_descent(lines, stages[-1], 200))
    stages.append(polished(lines, stages[-1]))
    peaks = [np.abs(lines.signal(phases)).max() for phases in stages]
    assert peaks == sorted(peaks, reverse=True)
    assert len(set(peaks)) == len(peaks)


def test_the_sweep_of_schroeder_is_flat_in_time() -> None:
    for index in (np.arange(1, 101), np.arange(1, 101)[::-1]):
        lines = designed_lines(index, np.ones(100), 1000)
        assert np.abs(lines.signal(schroeder_phases(lines))).max() / lines.rms < 1.75


def test_misuse_is_refused() -> None:
    with pytest.raises(RangeError, match="oversampling"):
        multisine([1], [1.0], 16, 0, oversampling=0)
    with pytest.raises(RangeError, match="at least 40 samples"):
        multisine([20], [1.0], 16, 0)
    with pytest.raises(RangeError, match="not all zero"):
        crest_factor(np.zeros(4))
    with pytest.raises(ShapeError):
        crest_factor(np.ones((2, 2)))
