"""What a record with varying scheduling shows, before anything is fitted to it."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, RangeError
from identification.measurements.inspection import MOST_LINES_LISTED
from identification.spectral.periodic_average import excited_lines
from identification.varying.records import (
    SteadyPeriods,
    VaryingRecord,
    common_period,
    periodicity,
    repetition_error,
    steady_periods,
)

SATURATED = 0.01
FEW_SAMPLES = 50


@dataclass(frozen=True, eq=False)
class VaryingInspection:
    """What a record shows; None where it cannot be known.

    `period` in samples after which input and scheduling repeat themselves, as stated or found (`period_detected`);
    `steady`: its steady periods when it is synchronised, `not_synchronised` otherwise why it is not;
    `input_deviation`, `scheduling_deviation`: largest difference one period apart over the root mean square, where
    there is a period to look at; `own_periods` of input and scheduling by themselves; `minimum`, `maximum` (n_p,) of
    p(t); `excited_frequencies` rad/s of all inputs; `noise_deviations` (n_y,); `saturated_fraction` the largest of all
    outputs.
    """

    samples: int
    duration: float
    period: int | None
    period_detected: bool
    steady: SteadyPeriods | None
    not_synchronised: str
    input_deviation: float | None
    scheduling_deviation: float | None
    own_periods: tuple[int | None, int | None]
    minimum: FloatArray
    maximum: FloatArray
    excited_frequencies: FloatArray
    noise_deviations: FloatArray | None
    signal_to_noise_db: float | None
    saturated_fraction: float
    warnings: tuple[str, ...]


def inspect_varying(record: VaryingRecord) -> VaryingInspection:
    """What a record shows, with warnings that say what to change; raises RangeError for a signal of zeros."""
    for name in ("input", "output"):
        silent = np.flatnonzero(~np.any(getattr(record, name), axis=0))
        if silent.size:
            raise RangeError(
                f"{name} {silent[0] + 1} is zero at every sample; check the recording and its channels", name
            )
    period, steady, reason = _synchronised(record)
    look_at = period or record.period
    deviations = {
        name: repetition_error(getattr(record, name), look_at) if look_at and look_at < len(record) else None
        for name in ("input", "scheduling")
    }
    noise = None if steady is None else _noise(steady)
    saturated = max(_saturated(y, len(record) // (period or len(record))) for y in record.output.T)
    return VaryingInspection(
        samples=len(record),
        duration=len(record) * record.sample_time,
        period=period or record.period,
        period_detected=record.period is None and period is not None,
        steady=steady,
        not_synchronised=reason,
        input_deviation=deviations["input"],
        scheduling_deviation=deviations["scheduling"],
        own_periods=(common_period(record.input), common_period(record.scheduling)),
        minimum=record.scheduling.min(axis=0),
        maximum=record.scheduling.max(axis=0),
        excited_frequencies=_excited(record, period),
        noise_deviations=noise,
        signal_to_noise_db=_signal_to_noise(steady, noise),
        saturated_fraction=saturated,
        warnings=_warnings(record, period, steady, reason, saturated),
    )


def _synchronised(record: VaryingRecord) -> tuple[int | None, SteadyPeriods | None, str]:
    """The common period, its steady periods, and why there are none."""
    try:
        period = periodicity(record).period
        return period, steady_periods(record), ""
    except MisuseError as error:
        return None, None, str(error)


def _noise(steady: SteadyPeriods) -> FloatArray:
    count, period, _ = steady.output.shape
    rest = steady.output - steady.output.mean(axis=0)
    return np.asarray(np.sqrt(np.sum(rest**2, axis=(0, 1)) / ((count - 1) * period)))


def _signal_to_noise(steady: SteadyPeriods | None, noise: FloatArray | None) -> float | None:
    """Power of the periodic part of the outputs over that of the noise, each output in units of its own size."""
    if steady is None or noise is None:
        return None
    size = steady.output.mean(axis=0).std(axis=0)
    ratio = float(np.mean((noise / np.where(size > 0, size, np.inf)) ** 2))
    return None if ratio <= 0 else -10 * float(np.log10(ratio))


def _excited(record: VaryingRecord, period: int | None) -> FloatArray:
    length = period or len(record)
    count = len(record) // length
    spectra = np.fft.rfft(record.input[: count * length].reshape(count, length, -1), axis=1)
    lines = np.zeros(spectra.shape[1], dtype=np.bool_)
    for i in range(spectra.shape[2]):
        lines |= excited_lines(spectra[:, :, i], 1e-3)
    return np.asarray(2 * np.pi * np.flatnonzero(lines)[:MOST_LINES_LISTED] / (length * record.sample_time))


def _saturated(y: FloatArray, periods: int) -> float:
    ends = max(int(np.sum(y == y.max())), int(np.sum(y == y.min())))
    return max(ends - periods, 0) / len(y)


def _first(numbers: list[int]) -> int:
    return numbers[0] if numbers else 0


def _warnings(
    record: VaryingRecord, period: int | None, steady: SteadyPeriods | None, reason: str, saturated: float
) -> tuple[str, ...]:
    still = [i + 1 for i, p in enumerate(record.scheduling.T) if np.ptp(p) <= 1e-9 * max(abs(p).max(), 1e-300)]
    constant = [i + 1 for i, u in enumerate(record.input.T) if np.ptp(u) <= 1e-12 * abs(u).max()]
    few = steady is not None and len(steady.output) < 3
    checks = (
        (bool(reason), f"No steady periods: {reason}. Methods that need no period can still be used."),
        (bool(still), f"Scheduling signal {_first(still)} does not vary: what depends on it cannot be seen; vary it."),
        (bool(constant), f"Input {_first(constant)} is constant: only the gain at frequency zero can be seen."),
        (few, "There are fewer than three steady periods, so the noise is hardly seen; record more periods."),
        (
            steady is not None and steady.dropped > 0,
            f"The first {0 if steady is None else steady.dropped} periods still show the transient.",
        ),
        (
            saturated > SATURATED,
            f"{100 * saturated:.0f} % of the samples of an output stand at its extreme value; the sensor or converter"
            " probably saturates: lower the input or widen the range.",
        ),
        (
            record.period is None and period is not None,
            f"Input and scheduling repeat themselves every {period} samples, though no period was stated; state it if"
            " that is meant.",
        ),
        (len(record) < FEW_SAMPLES, f"The record has {len(record)} samples only; record longer."),
    )
    return tuple(text for holds, text in checks if holds)
