"""From a designed spectrum to the signal that is played."""

from typing import Literal, Protocol, runtime_checkable

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.errors import MisuseError, RangeError
from oed.realisation.filtered_noise import filtered_noise
from oed.realisation.lines import signal_line_energies
from oed.realisation.multisine import crest_factor, multisine, peak_between_samples
from oed.realisation.realised_signal import RealisedSignal

LONGEST_NOISE = 4_000_000  # samples of noise in one record; a multisine repeats its period and may be longer
INTERPOLATION = 16  # points a sample at which the peak between samples is looked for

Method = Literal["multisine", "filtered_noise"]


@runtime_checkable
class Spectrum(Protocol):
    """A designed spectrum: it knows the energy of each DFT line of a record."""

    def line_energies(self, samples: int, sample_time: float) -> tuple[IntArray, FloatArray]:
        """Indices (K,) in 0..N/2 and energies (K,) of the lines of N samples; their sum is the energy."""


@runtime_checkable
class FilterSpectrum(Spectrum, Protocol):
    """A spectrum of finite degree, c_0 + 2 Σ c_i cos(iω): one that filtered white noise can have."""

    @property
    def coefficients(self) -> FloatArray:
        """c_0..c_L (L+1,), energies."""


@runtime_checkable
class FixedSignal(Spectrum, Protocol):
    """A design that is a signal already: what it shows depends on its level and phases."""

    def period(self) -> FloatArray:
        """One period of the signal."""


@runtime_checkable
class Designed(Protocol):
    """A designed experiment, of which only the spectrum is needed here."""

    @property
    def spectrum(self) -> Spectrum:
        """The spectrum at the operating point of the experiment."""


def realise(
    experiment: Designed | Spectrum,
    samples: int,
    sample_time: float,
    *,
    generator: np.random.Generator | int,
    method: Method = "multisine",
    periods: int = 1,
    amplitude_limit: float | None = None,
    oversampling: int = 1,
) -> RealisedSignal:
    """A signal with the designed spectrum, no sample of it above the amplitude limit.

        Σ_t u(t)² = E over all P periods of N samples;   max|u| = CR √(E/(PN)) ≤ limit   ⇔   P N ≥ E CR²/limit²

    `samples` N are those of one period, at which the lines lie on multiples of 2π/(N T_s) rad/s; `sample_time` T_s is
    in seconds. "multisine" plays the lines exactly, `periods` P times at the amplitude that shares the energy among
    the periods; several periods show the noise. "filtered_noise" plays one record of N samples of Gaussian noise,
    right on average. No signal is clipped, which would change its spectrum. Where the limit binds, the multisine is
    played for as many whole periods as are needed, the noise drawn anew for a longer record, with the same energy.

    A design that is a signal already is played as it is, `periods` times; an amplitude limit can only refuse it.
    `oversampling` is that of `multisine`; above 1 the limit holds between the samples too, where the reconstruction
    filter of the player fills them in: judged by `peak_between_samples` on a finer grid than the phases were chosen on.
    The same generator state gives the same signal. Raises RangeError for a sample time or limit that is not positive,
    or fewer than one period or sample; MisuseError for noise that is asked to have
    lines or periods; and what `multisine` and `filtered_noise` raise.
    """
    spectrum = experiment.spectrum if isinstance(experiment, Designed) else experiment
    _check(sample_time, periods, samples, amplitude_limit)
    random = np.random.default_rng(generator)
    if isinstance(spectrum, FixedSignal):
        return _as_designed(spectrum, samples, sample_time, method, periods, amplitude_limit, oversampling)
    if method == "multisine":
        index, energy = spectrum.line_energies(samples, sample_time)
        period = multisine(index, energy, samples, random, oversampling=oversampling)
        needed = (
            periods if amplitude_limit is None else max(periods, _shares(_peak(period, oversampling), amplitude_limit))
        )
        signal, asked = period / np.sqrt(needed), periods * samples
    elif method == "filtered_noise":
        signal, needed, asked = _noise(spectrum, samples, periods, amplitude_limit, random), 1, samples
        index, energy = spectrum.line_energies(len(signal), sample_time)
    else:
        raise MisuseError(f'method: "{method}" is neither "multisine" nor "filtered_noise"', "method")
    requested = np.zeros(len(signal) // 2 + 1)
    requested[index] = energy
    binds = needed * len(signal) > asked
    return RealisedSignal(
        signal=signal,
        periods=needed,
        sample_time=sample_time,
        method=method,
        crest_factor=crest_factor(signal),
        crest_factor_between_samples=crest_factor(signal, INTERPOLATION),
        requested_energies=requested,
        achieved_energies=needed * signal_line_energies(signal),
        amplitude_limit=amplitude_limit,
        amplitude_limit_binds=binds,
        needed_samples=needed * len(signal) if binds else None,
    )


def _as_designed(
    spectrum: FixedSignal,
    samples: int,
    sample_time: float,
    method: Method,
    periods: int,
    limit: float | None,
    oversampling: int,
) -> RealisedSignal:
    if method != "multisine":
        raise MisuseError("method: the design is a multisine of fixed phases; play it as one", "method")
    signal = spectrum.period()
    index, _ = spectrum.line_energies(samples, sample_time)
    peak = _peak(signal, oversampling)
    if limit is not None and peak > limit:
        raise RangeError(
            f"amplitude_limit: the designed signal reaches {peak:g}; design with lower levels", "amplitude_limit"
        )
    achieved = periods * signal_line_energies(signal)
    requested = np.zeros_like(achieved)
    requested[index] = achieved[index]
    return RealisedSignal(
        signal=signal,
        periods=periods,
        sample_time=sample_time,
        method=method,
        crest_factor=crest_factor(signal),
        crest_factor_between_samples=crest_factor(signal, INTERPOLATION),
        requested_energies=requested,
        achieved_energies=achieved,
        amplitude_limit=limit,
        amplitude_limit_binds=False,
        needed_samples=None,
    )


def _check(sample_time: float, periods: int, samples: int, amplitude_limit: float | None) -> None:
    if not (np.isfinite(sample_time) and sample_time > 0.0):
        raise RangeError(f"sample_time: {sample_time} s is not a positive time", "sample_time")
    if samples < 1:
        raise RangeError(f"samples: a period needs at least one sample, not {samples}", "samples")
    if periods < 1:
        raise RangeError(f"periods: {periods} periods are none; play at least one", "periods")
    if amplitude_limit is not None and not (np.isfinite(amplitude_limit) and amplitude_limit > 0.0):
        raise RangeError(f"amplitude_limit: {amplitude_limit} must be positive and finite, or None", "amplitude_limit")


def _peak(signal: FloatArray, oversampling: int) -> float:
    """The peak that the limit is for: of the samples, or with oversampling of what a reconstruction filter makes."""
    return float(np.abs(signal).max()) if oversampling == 1 else peak_between_samples(signal, oversampling)


def _shares(peak: float, limit: float) -> int:
    """Among how many periods the energy of one is shared until its peak keeps the limit."""
    return max(1, int(np.ceil((peak / limit) ** 2 * (1.0 - 1e-12))))


def _noise(
    spectrum: Spectrum, samples: int, periods: int, limit: float | None, random: np.random.Generator
) -> FloatArray:
    if not isinstance(spectrum, FilterSpectrum):
        raise MisuseError("method: noise has no lines; play a line spectrum as a multisine", "method")
    if periods != 1:
        raise MisuseError("periods: filtered noise does not repeat; give the samples of the whole record", "periods")
    while True:
        signal = filtered_noise(spectrum.coefficients, samples, random)
        excess = 0.0 if limit is None else float(np.abs(signal).max()) / limit
        if excess <= 1.0:
            return signal
        if samples * excess**2 > LONGEST_NOISE:
            raise RangeError(
                f"amplitude_limit: noise within it would take about {samples * excess**2:.1e} samples, more than"
                f" {LONGEST_NOISE}; raise the limit or play a multisine, whose period repeats",
                "amplitude_limit",
            )
        samples = int(np.ceil(samples * max(excess**2, 1.02)))
