"""What was measured while the scheduling varied: records with p(t), their periods, and their steady part."""

from dataclasses import dataclass
from math import lcm

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import FloatArray, finite_floats
from identification.errors import MisuseError, RangeError, ShapeError
from identification.measurements.inspection import find_period
from identification.scheduling import SchedulingVariable
from identification.signals import require_sampling
from identification.spectral.periodic_average import transient_periods

TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class VaryingRecord:
    """Input, output and measured scheduling signal of one experiment, u(t), y(t), p(t), t = 0 … N−1.

    `input` (N, n_u), `output` (N, n_y), `scheduling` (N, n_p), a vector standing for one channel; the constant that
    belongs to A_0 is no scheduling signal. `sample_time` in seconds; `period`: samples after which input and scheduling
    both repeat themselves, None when it is to be found or when there is none; `variables`: the n_p scheduling variables
    with their declared ranges, or none. Raises ShapeError for sizes that do not fit and RangeError for values that are
    not finite, a sample time ≤ 0, a period beyond the record, or scheduling outside the declared range.
    """

    input: FloatArray
    output: FloatArray
    scheduling: FloatArray
    sample_time: float
    period: int | None = None
    variables: tuple[SchedulingVariable, ...] = ()

    def __post_init__(self) -> None:
        for name in ("input", "output", "scheduling"):
            object.__setattr__(self, name, as_channels(getattr(self, name), name))
            if len(getattr(self, name)) != len(self.input):
                raise ShapeError(
                    f"{name} has {len(getattr(self, name))} samples, the input {len(self.input)}; give equal lengths",
                    name,
                )
        require_sampling(len(self), self.sample_time, self.period)
        require_within_range(self.variables, self.scheduling)

    def __len__(self) -> int:
        return len(self.input)

    def part(self, start: int, stop: int) -> "VaryingRecord":
        """Samples start … stop − 1, as a record without a stated period."""
        cut = slice(start, stop)
        return VaryingRecord(
            self.input[cut], self.output[cut], self.scheduling[cut], self.sample_time, None, self.variables
        )


def as_channels(signal: ArrayLike, field: str) -> FloatArray:
    """A signal (N,) or (N, channels) as (N, channels), read-only; raises ShapeError and RangeError."""
    array = finite_floats(signal, field)
    if array.ndim == 1:
        array = array[:, None]
    if array.ndim != 2 or array.shape[1] == 0:
        raise ShapeError(f"{field} has shape {array.shape}; give (samples, channels)", field)
    return array


def require_within_range(variables: tuple[SchedulingVariable, ...], scheduling: FloatArray) -> None:
    """Raise RangeError when p(t) (..., N, n_p) leaves the declared range of a variable by more than rounding."""
    if not variables:
        return
    if len(variables) != scheduling.shape[-1]:
        raise ShapeError(
            f"{len(variables)} scheduling variables are declared and {scheduling.shape[-1]} signals given", "scheduling"
        )
    for i, variable in enumerate(variables):
        low, high = float(scheduling[..., i].min()), float(scheduling[..., i].max())
        slack = 1e-9 * (variable.maximum - variable.minimum)
        if low < variable.minimum - slack or high > variable.maximum + slack:
            raise RangeError(
                f"{variable.name} runs from {low:.6g} to {high:.6g} {variable.unit}, outside its declared range"
                f" {variable.minimum:.6g} to {variable.maximum:.6g}; declare the range that is meant or remove samples",
                "scheduling",
            )


@dataclass(frozen=True)
class Periodicity:
    """`period` P of input and scheduling together, `scheduling_period` T (a divisor of P), in samples.

    `deviation`: largest difference between samples one period apart, over the root mean square of what varies.
    """

    period: int
    scheduling_period: int
    deviation: float


def repetition_error(signal: FloatArray, period: int) -> float:
    """The largest |x(t + P) − x(t)| of a signal (N, channels) over the root mean square of its varying part."""
    difference = np.max(abs(signal[period:] - signal[:-period]), axis=0, initial=0.0)
    scale = np.sqrt(np.mean((signal - signal.mean(axis=0)) ** 2, axis=0))
    floor = 1e-9 * np.maximum(abs(signal).max(axis=0), 1e-300)
    return float(np.max(difference / np.maximum(scale, floor)))


def common_period(signal: FloatArray) -> int | None:
    """The shortest period of all channels (N, channels) together, 1 when they are constant, None when there is none."""
    period = 1
    for channel in signal.T:
        if np.ptp(channel) <= 1e-9 * max(abs(channel).max(), 1e-300):
            continue
        found = find_period(channel)
        if found is None:
            return None
        period = lcm(period, found)
    return period


def periodicity(record: VaryingRecord, tolerance: float = TOLERANCE) -> Periodicity:
    """The period that input and scheduling have in common, stated or found, checked over the whole record.

    The scheduling period T is the smallest divisor of P after which p(t) repeats itself. `tolerance` is the largest
    repetition error (see `repetition_error`) that passes; a noisy measurement of p(t) needs a larger one, and a stated
    period. Raises MisuseError, saying how far off they are, when input or scheduling do not repeat themselves or are
    not synchronised, and when the record holds fewer than two periods.
    """
    period = record.period or _found_period(record)
    if len(record) < 2 * period:
        raise MisuseError(
            f"the record holds {len(record) / period:.3g} periods of {period} samples; record at least two", "period"
        )
    errors = {name: repetition_error(getattr(record, name), period) for name in ("input", "scheduling")}
    for name, error in errors.items():
        if error > tolerance:
            raise MisuseError(_not_repeated(record, name, period, error, tolerance), name)
    shortest = _shortest(record.scheduling, period, max(tolerance, errors["scheduling"]))
    return Periodicity(period, shortest, max(errors.values()))


def scheduling_period(record: VaryingRecord, tolerance: float = TOLERANCE) -> int:
    """The period T of p(t) in samples where the input need not be periodic; 1 for constant scheduling.

    Raises MisuseError, saying how far off it is, when the scheduling does not repeat itself.
    """
    if record.period is None:
        found = common_period(record.scheduling)
        if found is None:
            raise MisuseError(_nothing_found(record, "scheduling"), "scheduling")
        return found
    error = repetition_error(record.scheduling, record.period)
    if error > tolerance:
        raise MisuseError(_not_repeated(record, "scheduling", record.period, error, tolerance), "scheduling")
    return _shortest(record.scheduling, record.period, max(tolerance, error))


def _shortest(scheduling: FloatArray, period: int, tolerance: float) -> int:
    p = scheduling[: 2 * period]
    divisors = (d for d in range(1, period + 1) if period % d == 0)
    return next(d for d in divisors if repetition_error(p, d) <= tolerance)


def _nothing_found(record: VaryingRecord, name: str) -> str:
    return (
        f"the {name} does not repeat itself within half the record of {len(record)} samples; play whole periods, or"
        " state the period to learn how far off it is"
    )


def _found_period(record: VaryingRecord) -> int:
    found = {name: common_period(getattr(record, name)) for name in ("input", "scheduling")}
    for name, period in found.items():
        if period is None:
            raise MisuseError(_nothing_found(record, name), name)
    of_input, of_scheduling = int(found["input"] or 1), int(found["scheduling"] or 1)
    together = lcm(of_input, of_scheduling)
    if 2 * together > len(record):
        raise MisuseError(
            f"input and scheduling are not synchronised: they repeat after {of_input} and {of_scheduling} samples, so"
            f" together only after {together}, of which the record holds {len(record) / together:.3g}; the input period"
            f" is {of_input / of_scheduling:.6g} scheduling periods: make it a whole number, or record longer",
            "scheduling",
        )
    return max(together, 2)


def _not_repeated(record: VaryingRecord, name: str, period: int, error: float, tolerance: float) -> str:
    own = common_period(getattr(record, name))
    slip = ""
    if own is not None and own > 1:
        slip = f"; it repeats after {own} samples, and the period is {period / own:.6g} of these, not a whole number"
    return (
        f"the {name} does not repeat itself after the period of {period} samples: samples one period apart differ by up"
        f" to {error:.3g} of its root mean square, {tolerance:.3g} is allowed{slip}; synchronise input, scheduling and"
        " sampling, or state the right period"
    )


@dataclass(frozen=True, eq=False)
class SteadyPeriods:
    """N_p steady periods: `input` and `scheduling` one mean period, (P, ·); `output` (N_p, P, n_y).

    `dropped` leading periods were left out by `rule`, and `left_over` samples after the last whole period.
    """

    periodicity: Periodicity
    input: FloatArray
    scheduling: FloatArray
    output: FloatArray
    dropped: int
    left_over: int
    rule: str


def steady_periods(
    record: VaryingRecord, drop_periods: int | None = None, tolerance: float = TOLERANCE
) -> SteadyPeriods:
    """The steady periods of a synchronised periodic record.

    With `drop_periods` None, leading periods, at most half of them, are dropped while their difference from the mean
    of the later half has an energy beyond the 99.9 % quantile of what the noise there gives; with a single pair of
    periods the first is kept. Raises MisuseError when fewer than two periods remain, and as `periodicity` does.
    """
    found = periodicity(record, tolerance)
    count = len(record) // found.period

    def shaped(signal: FloatArray) -> FloatArray:
        return signal[: count * found.period].reshape(count, found.period, -1)

    output = shaped(record.output)
    if drop_periods is None:
        spectra = np.fft.rfft(output, axis=1).reshape(count, -1)
        dropped = transient_periods(spectra - spectra.mean(axis=0))
        rule = "energy of a leading period's deviation beyond the 99.9 % quantile of the later half's noise"
    else:
        dropped, rule = drop_periods, "as many as asked for"
    if dropped < 0 or count - dropped < 2:
        raise MisuseError(
            f"the record holds {count} whole periods of {found.period} samples and {dropped} are dropped; at least two"
            " must remain: record more periods or drop fewer",
            "drop_periods",
        )
    return SteadyPeriods(
        found,
        shaped(record.input)[dropped:].mean(axis=0),
        shaped(record.scheduling)[dropped:].mean(axis=0),
        output[dropped:],
        dropped,
        len(record) - count * found.period,
        rule,
    )
