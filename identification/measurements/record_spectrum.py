"""The spectrum of a time record, to be looked at: amplitudes of input, output and noise at each line."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.measurements.inspection import find_period
from identification.signals import TimeRecord
from identification.spectral.periodic_average import excited_lines, transient_periods

THRESHOLD = 1e-3


@dataclass(frozen=True, eq=False)
class RecordSpectrum:
    """Amplitudes (F,) at frequencies (F,) in rad/s, of the mean over `periods` steady periods.

    `noise` is the standard deviation of the output's amplitude, None when there is one period only.
    """

    frequencies: FloatArray
    input: FloatArray
    output: FloatArray
    noise: FloatArray | None
    excited: BoolArray
    periods: int


def record_spectrum(record: TimeRecord, most: int = 4000) -> RecordSpectrum:
    """The spectrum of a record, over its period where it has one, else over all samples.

        X_k = (2/L) |Σ_p Σ_t x_p(t) e^{−2πikt/L}|/P,   σ_k² = (4/L²) Σ_p |Y_pk − Ȳ_k|² / (P(P − 1))

    over P steady periods of L samples; the constant part counts once. Of more than `most` lines those are kept that
    stand out in their neighbourhoods, at the input or else at the output.
    """
    period = record.period or find_period(record.input) or len(record)
    u, y = (_spectra(x, period) for x in (record.input, record.output))
    dropped = transient_periods(y) if len(y) > 1 else 0
    u, y = u[dropped:], y[dropped:]
    excited = excited_lines(u, THRESHOLD)
    scale = np.full(y.shape[1], 2 / period)
    scale[0] = 1 / period
    if period % 2 == 0:
        scale[-1] = 1 / period
    noise = np.sqrt(np.var(y, axis=0, ddof=1) / len(y)) * scale if len(y) > 1 else None
    inputs, outputs = abs(u.mean(axis=0)) * scale, abs(y.mean(axis=0)) * scale
    kept = _outstanding(np.where(excited, inputs.max(initial=0.0) + inputs, 0.0), outputs, most)
    return RecordSpectrum(
        frequencies=np.asarray(2 * np.pi * kept / (period * record.sample_time), dtype=np.float64),
        input=inputs[kept],
        output=outputs[kept],
        noise=None if noise is None else noise[kept],
        excited=excited[kept],
        periods=len(y),
    )


def _spectra(x: FloatArray, period: int) -> ComplexArray:
    periods = len(x) // period
    return np.asarray(np.fft.rfft(x[: periods * period].reshape(periods, period)), dtype=np.complex128)


def _outstanding(first: FloatArray, second: FloatArray, most: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """The line of each of `most` neighbourhoods with the largest `first`, of equal ones with the largest `second`."""
    if len(first) <= most:
        return np.arange(len(first))
    order = np.lexsort((second, first))
    places = order * most // len(first)
    largest = np.zeros(most, dtype=np.intp)
    largest[places] = order
    return largest
