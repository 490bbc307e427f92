"""Designed spectra as signals: the energy is kept, the amplitude limit too, and the duration follows from both."""

from dataclasses import dataclass

import numpy as np
import pytest

from identification.errors import MisuseError, RangeError
from oed.realisation import RealisedSignal, energy_deviation, realise
from oed.spectra.fir import FirSpectrum
from oed.spectra.lines import LineSpectrum

N, TS = 500, 0.1
INDEX = np.array([0, 8, 57, 110])
LINES = LineSpectrum(2.0 * np.pi * INDEX / (N * TS), np.array([900.0, 400.0, 250.0, 50.0]), INDEX, N)
H = np.array([1.0, -1.2, 0.5])
FIR = FirSpectrum(np.correlate(H, H, "full")[2:] * 300.0, TS)


@dataclass(frozen=True)
class Experiment:
    """As a design returns them, as far as it matters here."""

    spectrum: LineSpectrum | FirSpectrum


def play(**options: object) -> RealisedSignal:
    return realise(LINES, N, TS, generator=0, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("spectrum", [LINES, FIR])
def test_the_requested_energies_are_achieved(spectrum: LineSpectrum | FirSpectrum) -> None:
    signal = realise(Experiment(spectrum), N, TS, generator=1)
    assert signal.requested_energies.sum() == pytest.approx(spectrum.energy)
    floor = 1e-26 * spectrum.energy
    assert signal.achieved_energies == pytest.approx(signal.requested_energies, rel=1e-10, abs=floor)
    assert np.sum(signal.record() ** 2) == pytest.approx(spectrum.energy, rel=1e-12)
    assert (signal.samples, signal.period, signal.periods) == (N, N, 1)
    assert signal.duration == pytest.approx(50.0)
    assert not signal.amplitude_limit_binds
    assert signal.needed_samples is None


def test_periods_share_the_energy() -> None:
    once, thrice = play(), play(periods=3)
    assert thrice.signal == pytest.approx(once.signal / np.sqrt(3.0))
    assert thrice.record() == pytest.approx(np.tile(thrice.signal, 3))
    assert thrice.energy == pytest.approx(LINES.energy)
    assert thrice.achieved_energies == pytest.approx(once.achieved_energies, rel=1e-12, abs=1e-20)
    assert thrice.crest_factor == pytest.approx(once.crest_factor)
    assert thrice.samples == 3 * N
    assert thrice.needed_samples is None


@pytest.mark.parametrize("share", [0.99, 0.5, 0.3, 0.031])
def test_a_binding_limit_takes_as_many_whole_periods_as_needed_and_no_more(share: float) -> None:
    free = play()
    bound = play(amplitude_limit=share * free.peak)
    least = free.energy * free.crest_factor**2 / (share * free.peak) ** 2
    assert bound.amplitude_limit_binds
    assert bound.needed_samples == bound.samples == N * int(np.ceil(least / N))
    assert bound.peak <= share * free.peak
    assert bound.energy == pytest.approx(LINES.energy)
    assert bound.achieved_energies == pytest.approx(bound.requested_energies, rel=1e-10, abs=1e-20)


def test_a_limit_that_the_periods_keep_already_does_not_bind() -> None:
    free = play()
    loose = play(amplitude_limit=0.6 * free.peak, periods=4)
    assert (loose.periods, loose.amplitude_limit_binds, loose.needed_samples) == (4, False, None)
    tight = play(amplitude_limit=0.4 * free.peak, periods=4)
    assert (tight.periods, tight.amplitude_limit_binds, tight.needed_samples) == (7, True, 7 * N)


def test_a_limit_at_the_peak_does_not_bind() -> None:
    assert not play(amplitude_limit=play().peak).amplitude_limit_binds


def test_with_oversampling_the_limit_holds_between_the_samples() -> None:
    index = np.arange(1, 21)
    flat = LineSpectrum(np.asarray(2.0 * np.pi / (48 * TS) * index, dtype=np.float64), np.ones(20), index, 48)
    plain, fine = (
        realise(flat, 48, TS, generator=0, oversampling=oversampling, amplitude_limit=0.3) for oversampling in (1, 4)
    )
    between = [s.crest_factor_between_samples * np.sqrt(s.energy / s.samples) for s in (plain, fine)]
    assert between[1] <= 0.3 < between[0]
    assert plain.peak <= 0.3


@pytest.mark.parametrize("oversampling", [2, 4, 8])
@pytest.mark.parametrize("seed", range(3))
def test_between_the_samples_no_limit_is_exceeded_however_coarse_the_grid_was(oversampling: int, seed: int) -> None:
    """Summed as cosines at many instants of no grid in common with those that phases were chosen or judged on."""
    index = np.arange(1 + seed, 24)
    flat = LineSpectrum(np.asarray(2.0 * np.pi / (48 * TS) * index, dtype=np.float64), np.ones(len(index)), index, 48)
    free = realise(flat, 48, TS, generator=seed, oversampling=oversampling)
    limit = 0.71 * free.peak
    played = realise(flat, 48, TS, generator=seed, oversampling=oversampling, amplitude_limit=limit)
    lines = np.fft.rfft(played.signal) / 24
    instants = np.random.default_rng(seed).uniform(0, 48, 40_000)
    between = (lines[index] * np.exp(2j * np.pi * np.outer(instants, index) / 48)).real.sum(axis=1)
    assert abs(between).max() <= limit
    assert played.energy == pytest.approx(free.energy)


def test_noise_has_the_energy_within_its_deviation() -> None:
    signal = realise(FIR, 4000, TS, generator=2, method="filtered_noise")
    assert abs(signal.energy - FIR.energy) < 4.0 * energy_deviation(FIR.coefficients, 4000)
    assert signal.achieved_energies.sum() == pytest.approx(signal.energy)
    assert signal.requested_energies.sum() == pytest.approx(FIR.energy)
    assert (signal.samples, signal.periods) == (4000, 1)


def test_noise_within_a_limit_is_longer_and_not_clipped() -> None:
    free = realise(FIR, 1000, TS, generator=2, method="filtered_noise")
    limit = 0.5 * free.peak
    bound = realise(FIR, 1000, TS, generator=2, method="filtered_noise", amplitude_limit=limit)
    assert bound.amplitude_limit_binds
    assert bound.needed_samples == bound.samples > 3000
    assert bound.peak <= limit
    assert np.sum(np.abs(bound.signal) == bound.peak) == 1
    assert abs(bound.energy - FIR.energy) < 4.0 * energy_deviation(FIR.coefficients, bound.samples)


@pytest.mark.parametrize("method", ["multisine", "filtered_noise"])
def test_the_same_seed_gives_the_same_bytes(method: str) -> None:
    first, second = (
        realise(FIR, 64, TS, generator=3, method=method)  # type: ignore[arg-type]
        for _ in range(2)
    )
    assert first.signal.tobytes() == second.signal.tobytes()


@pytest.mark.parametrize(
    ("options", "error", "says"),
    [
        ({"amplitude_limit": 0.0}, RangeError, "positive"),
        ({"amplitude_limit": -1.0}, RangeError, "positive"),
        ({"amplitude_limit": np.nan}, RangeError, "positive"),
        ({"periods": 0}, RangeError, "at least one"),
        ({"method": "chirp"}, MisuseError, "neither"),
        ({"method": "filtered_noise"}, MisuseError, "no lines"),
    ],
)
def test_misuse_says_what_to_change(options: dict[str, object], error: type[MisuseError], says: str) -> None:
    with pytest.raises(error, match=says):
        play(**options)


def test_a_record_that_does_not_hold_the_lines_is_refused() -> None:
    with pytest.raises(RangeError, match="multiple of 500"):
        realise(LINES, 499, TS, generator=0)
    with pytest.raises(RangeError, match="not a positive time"):
        realise(FIR, 100, 0.0, generator=0)
    with pytest.raises(RangeError, match="at least one sample"):
        realise(FIR, 0, TS, generator=0)


def test_noise_that_would_fill_the_memory_or_repeat_is_refused() -> None:
    with pytest.raises(RangeError, match="play a multisine"):
        realise(FIR, 100, TS, generator=0, method="filtered_noise", amplitude_limit=1e-4)
    with pytest.raises(MisuseError, match="does not repeat"):
        realise(FIR, 100, TS, generator=0, method="filtered_noise", periods=2)
