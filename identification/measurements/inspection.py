"""What a measurement shows, before anything is fitted to it."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from identification.arrays import ComplexArray, FloatArray
from identification.errors import RangeError
from identification.measurements.feedback import feedback_warnings
from identification.signals import FrequencyResponse, TimeRecord
from identification.spectral.periodic_average import excited_lines, transient_periods

MOST_LINES_LISTED = 1000


@dataclass(frozen=True, eq=False)
class RecordInspection:
    """What a time record shows; None where it cannot be known from this record.

    `duration` in s; `period` in samples, `period_detected` when it was found and not stated; `excited_frequencies` in
    rad/s (at most a thousand); `noise_deviation`: standard deviation of the output noise; `signal_to_noise_db`: power
    of the periodic part of the output, mean left out, over that of the noise; `output_trend`: total change over the
    record of a significant straight line; `outliers`: samples far outside the noise; offsets are mean values.
    """

    samples: int
    duration: float
    period: int | None
    period_detected: bool
    periods: int
    transient_periods: int | None
    excited_frequencies: FloatArray
    noise_deviation: float | None
    signal_to_noise_db: float | None
    saturated_fraction: float
    input_offset: float
    output_offset: float
    output_trend: float | None
    outliers: int
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class ResponseInspection:
    """What a frequency response shows: band in rad/s, spacing, and the median relative standard deviation."""

    count: int
    lowest_frequency: float
    highest_frequency: float
    spacing: Literal["linear", "logarithmic", "irregular"]
    variance_known: bool
    variance_degrees_of_freedom: float | None
    relative_deviation: float | None
    warnings: tuple[str, ...]


def inspect(measurement: TimeRecord | FrequencyResponse) -> RecordInspection | ResponseInspection:
    """What a measurement shows, with warnings that say what to change.

    The period is stated or found by exact repetition of the input; the noise is what differs between steady periods.
    Feedback that was not stated is looked for (`feedback_test`).
    Raises RangeError for records or responses of zeros, which cannot be a measurement. Responses with several inputs or
    outputs are judged by the Frobenius norms of their matrices.
    """
    if isinstance(measurement, TimeRecord):
        seen = inspect_record(measurement)
        return replace(seen, warnings=(*seen.warnings, *feedback_warnings(measurement)))
    return _inspect_response(measurement)


def find_period(u: FloatArray) -> int | None:
    """The shortest period in samples with which u (N,) repeats itself at least once in full, None when it does not.

    Repetition is exact up to 10⁻⁶ of the root mean square of u. A constant input has no period.
    """
    varying = u - u.mean()
    if not np.any(abs(varying) > 1e-9 * max(abs(u).max(), 1e-300)):
        return None
    size = 2 ** int(np.ceil(np.log2(2 * len(u))))
    power = np.fft.irfft(abs(np.fft.rfft(varying, size)) ** 2)[: len(u) // 2 + 1]
    energy = np.cumsum(varying**2)
    lags = np.arange(2, len(u) // 2 + 1)
    ahead, behind = energy[-1] - energy[lags - 1], energy[len(u) - lags - 1]
    likely = lags[power[lags] > (1 - 1e-6) * (ahead + behind) / 2]
    tolerance = 1e-6 * np.sqrt(np.mean(varying**2))
    return next((int(lag) for lag in likely if np.all(abs(u[lag:] - u[:-lag]) <= tolerance)), None)


def inspect_record(record: TimeRecord) -> RecordInspection:
    """The same of a record."""
    u, y = record.input, record.output
    for name, signal in (("input", u), ("output", y)):
        if not signal.any():
            raise RangeError(f"the {name} is zero at every sample; check the recording and its channels", name)
    found = find_period(u) if record.period is None else None
    period = record.period or found
    periods = 1 if period is None else len(u) // period
    noise, steady, dropped = _noise_and_signal(y, period, periods)
    trend = _trend(y, period, periods)
    result = RecordInspection(
        samples=len(u),
        duration=len(u) * record.sample_time,
        period=period,
        period_detected=found is not None,
        periods=periods,
        transient_periods=dropped,
        excited_frequencies=_excited(u, period, periods, record.sample_time),
        noise_deviation=noise,
        signal_to_noise_db=float(20 * np.log10(steady / noise)) if noise and steady else None,
        saturated_fraction=_saturated(y, periods),
        input_offset=float(u.mean()),
        output_offset=float(y.mean()),
        output_trend=trend,
        outliers=_outliers(y, period, periods),
        warnings=(),
    )
    return _with_warnings(result, record)


def _spectra(x: FloatArray, period: int, periods: int) -> ComplexArray:
    return np.asarray(np.fft.rfft(x[: periods * period].reshape(periods, period)), dtype=np.complex128)


def _excited(u: FloatArray, period: int | None, periods: int, step: float) -> FloatArray:
    length = period or len(u)
    lines = np.flatnonzero(excited_lines(_spectra(u, length, periods), 1e-3))
    return np.asarray(2 * np.pi * lines[:MOST_LINES_LISTED] / (length * step), dtype=np.float64)


def _noise_and_signal(y: FloatArray, period: int | None, periods: int) -> tuple[float | None, float | None, int | None]:
    """Standard deviation of the noise, root mean square of the periodic part, and transient periods."""
    if period is None or periods < 2:
        return None, None, None
    dropped = transient_periods(_spectra(y, period, periods))
    steady = y[: periods * period].reshape(periods, period)[dropped:]
    mean = steady.mean(axis=0)
    noise = float(np.sqrt(np.sum((steady - mean) ** 2) / ((len(steady) - 1) * period)))
    return noise, float(np.std(mean)), dropped


def _saturated(y: FloatArray, periods: int) -> float:
    """Fraction of samples exactly at the largest or the smallest value, beyond one a period."""
    if y.max() == y.min():
        return 1.0
    ends = max(int(np.sum(y == y.max())), int(np.sum(y == y.min())))
    return max(ends - periods, 0) / len(y)


def _trend(y: FloatArray, period: int | None, periods: int) -> float | None:
    """Change of a straight line over the record, significant at 0.1 %, from means of whole periods or of blocks."""
    blocks = periods if period is not None and periods >= 4 else min(20, len(y) // 8)
    if blocks < 4:
        return None
    length = period if period is not None and periods >= 4 else len(y) // blocks
    means = y[: blocks * length].reshape(blocks, length).mean(axis=1)
    if np.ptp(means) <= 1e-9 * abs(y).max():
        return None
    from scipy.stats import linregress

    line = linregress(np.arange(blocks), means)
    change = float(line.slope) * len(y) / length
    return change if line.pvalue < 1e-3 and abs(change) > 0.1 * float(np.std(y)) else None


def _outliers(y: FloatArray, period: int | None, periods: int) -> int:
    """Samples further than eight robust standard deviations from their median over periods.

    Without periods: from the median of five neighbours, and by more than four times what the other four span.
    """
    if period is not None and periods >= 3:
        blocks = y[: periods * period].reshape(periods, period)
        late = blocks[1:] if periods > 3 else blocks
        rest, local = (late - np.median(late, axis=0)).ravel(), np.zeros(late.size)
    elif len(y) < 12:
        return 0
    else:
        around = sliding_window_view(y, 5)
        rest = around[:, 2] - np.median(around, axis=1)
        local = 4 * np.ptp(around[:, [0, 1, 3, 4]], axis=1)
    scale = max(1.4826 * float(np.quantile(abs(rest), 0.6)), 1e-6 * float(np.std(y)))
    return int(np.sum(abs(rest) > 8 * scale + local))


def _with_warnings(result: RecordInspection, record: TimeRecord) -> RecordInspection:
    u, y = record.input, record.output
    constant = np.ptp(u) <= 1e-12 * abs(u).max()
    noise_only = result.signal_to_noise_db is not None and result.signal_to_noise_db < 0
    checks = (
        (
            bool(constant),
            "The input is constant: only the gain at frequency zero can be seen; excite more frequencies.",
        ),
        (bool(np.ptp(y) == 0), "The output does not change; check the sensor and its range."),
        (
            result.saturated_fraction > 0.01,
            f"{100 * result.saturated_fraction:.0f} % of the output samples stand at its extreme value; the sensor or"
            " converter probably saturates: lower the input or widen the range.",
        ),
        (
            result.output_trend is not None,
            f"The output drifts by {result.output_trend or 0:.3g} over the record; let the plant settle or remove the"
            " drift.",
        ),
        (
            result.outliers > 0,
            f"{result.outliers} output samples lie far outside the rest; check for disturbances and repair them.",
        ),
        (
            result.period_detected,
            f"The input repeats itself every {result.period} samples, though no period was stated; state it if that is"
            " meant.",
        ),
        (
            record.period is not None and result.periods == 1,
            "The record holds one period only, so the noise cannot be seen; record more periods.",
        ),
        (bool(result.transient_periods), f"The first {result.transient_periods} periods still show the transient."),
        (noise_only, "The noise is stronger than the response; raise the input or record longer."),
        (len(u) < 50, f"The record has {len(u)} samples only; record longer."),
    )
    texts = tuple(text for holds, text in checks if holds)
    return RecordInspection(**{**vars(result), "warnings": texts})


def _inspect_response(data: FrequencyResponse) -> ResponseInspection:
    if not data.response.any():
        raise RangeError("the response is zero at every frequency; check the measurement", "response")
    size = np.linalg.norm(data.matrices, axis=(1, 2))
    relative = None
    if data.variance is not None:
        deviation = np.sqrt(data.variance.reshape(data.matrices.shape).sum(axis=(1, 2)))
        relative = float(np.median(deviation[size > 0] / size[size > 0]))
    d = data.variance_degrees_of_freedom
    checks = (
        (data.variance is None, "No variance was given; the noise will be judged from the fit."),
        (relative is not None and relative > 1, "The noise is larger than the response at most frequencies."),
        (
            d is not None and d <= 2,
            "The variances come from too few periods to weight a fit with; measure at least four periods.",
        ),
        (bool(np.any(size == 0)), "The response is exactly zero at some frequencies; check or remove them."),
        (len(data) < 10, f"There are {len(data)} frequencies only; only models of low order can be told from these."),
    )
    return ResponseInspection(
        count=len(data),
        lowest_frequency=float(data.frequencies.min()),
        highest_frequency=float(data.frequencies.max()),
        spacing=_spacing(np.sort(data.frequencies)),
        variance_known=data.variance is not None,
        variance_degrees_of_freedom=d,
        relative_deviation=relative,
        warnings=tuple(text for holds, text in checks if holds),
    )


def _spacing(frequencies: FloatArray) -> Literal["linear", "logarithmic", "irregular"]:
    """Linear where all steps are multiples of one; logarithmic where the ratios are alike within 10 %."""
    steps = np.diff(frequencies)
    if len(steps) < 2:
        return "irregular"
    multiples = steps / steps.min()
    if np.all(abs(multiples - np.round(multiples)) < 1e-3) and multiples.max() < 20:
        return "linear"
    positive = frequencies[frequencies > 0]
    ratios = np.diff(np.log(positive))
    return "logarithmic" if len(ratios) > 1 and np.ptp(ratios) < 0.2 * np.median(ratios) else "irregular"
