"""Frequency response of a periodic record by averaging over periods."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from scipy.special import fdtri

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.errors import MisuseError, RangeError
from identification.lti.response_tests import real_lines
from identification.measurements.input_errors import InputErrors
from identification.signals import FrequencyResponse, TimeRecord
from identification.spectral.resolution import converter_step, repeated_error, require_changing


@dataclass(frozen=True)
class PeriodicAverage:
    """Averages the spectra of P steady periods and takes the noise from how they differ.

        Ĝ_k = Ȳ_k/Ū_k,   σ̂_k² = Σ_p |Y_kp − Ĝ_k U_kp|² / (P(P − 1)|Ū_k|²)      [PintelonSchoukens2012, (2-31)–(2-33)]

    σ̂_k² is |Ĝ|²(σ_Y²/|Y|² + σ_U²/|U|² − 2 Re σ_YU/(Y U*)) of the sample (co)variances, so noise on the input counts and
    an input repeated exactly is a special case. Where it is not, the errors of both signals go along (`input_errors`),
    from which estimators weigh without the noise of the datum. σ̂_k² has d = P − 1 degrees of freedom
    (σ̂² ~ σ² χ²_{2d}/2d). At ω = 0 and at the Nyquist frequency the response is real: there σ̂² is twice the variance of
    the real number, with d instead of 2d real degrees of freedom; `real_lines=False` leaves those lines out. ω = 0 is
    used only where the operating levels were stated: otherwise a mean value says nothing about the gain.

    Excited lines are those with |Ū_k| above `threshold` times the largest and above four of its standard deviations.
    With `drop_periods` None, leading periods, at most half of them, are dropped while the energy of their difference
    from the mean of the later half is beyond the 99.9 % quantile of what the noise there gives (F distribution).
    Variances below rounding errors are set to those; the rounding of a converter whose step shows is added. Assumes
    an exact period, open loop, and noise whose correlation is short against the period.
    """

    kind: ClassVar[str] = "periodic_average"

    drop_periods: Annotated[
        int | None, "leading periods left out as transient; found from the record when not given"
    ] = None
    threshold: Annotated[float, "smallest amplitude of an excited line, as a fraction of the largest"] = 1e-3
    real_lines: Annotated[
        bool, "keep the lines at zero (where the levels were stated) and at the Nyquist frequency"
    ] = True
    continuous_time: Annotated[bool, "the response is that of a continuous-time plant (band-limited measurement)"] = (
        False
    )

    @classmethod
    def example(cls) -> "PeriodicAverage":
        """An instance for tests and catalogues."""
        return cls()

    def __post_init__(self) -> None:
        if self.drop_periods is not None and self.drop_periods < 0:
            raise RangeError(f"drop_periods is {self.drop_periods}; it must be zero or more", "drop_periods")
        if not 0 <= self.threshold < 1:
            raise RangeError(f"the threshold is {self.threshold}; it must lie in [0, 1)", "threshold")

    def estimate(self, record: TimeRecord) -> FrequencyResponse:
        """Ĝ at the excited lines of a record of two or more steady periods, with variances.

        Raises MisuseError for a record without period, with fewer than two usable periods, or with a zero input.
        """
        u, y = self.steady_spectra(record.about_its_level())
        count = len(u)
        lines = excited_lines(u, self.threshold)
        lines[0] &= record.level_known
        omega = np.asarray(2 * np.pi * np.fft.rfftfreq(_period(record), record.sample_time), dtype=np.float64)
        real = real_lines(omega, record.sample_time)
        lines &= ~real | self.real_lines
        if not lines.any():
            raise MisuseError(
                "the input excites no line of its period; check the input or lower the threshold", "input"
            )
        mean = u[:, lines].mean(axis=0)
        response = y[:, lines].mean(axis=0) / mean
        errors = y[:, lines] - response * u[:, lines]
        power = np.sum(abs(errors) ** 2, axis=0) / (count - 1) * np.where(real[lines], 2.0, 1.0)
        rounding = self._converter(record, y) * np.where(real[lines], 2, 1)
        least = _rounding(u, y, response)
        power = np.maximum(power, least) + rounding
        variance = power / (count * abs(mean) ** 2)
        return FrequencyResponse(
            omega[lines],
            response,
            record.operating_point,
            None if self.continuous_time else record.sample_time,
            variance,
            float(count - 1),
            held=record.held if self.continuous_time else None,
            input_errors=InputErrors.of_mean(u[:, lines], y[:, lines], least + rounding, real[lines]),
        )

    @staticmethod
    def _converter(record: TimeRecord, y: ComplexArray) -> float:
        """The power of the rounding of the converter at each line; it repeats, so that periods do not lessen it."""
        step = converter_step(record.output)
        if step == 0:
            return 0.0
        period, count = _period(record), len(y)
        inner = np.where(real_lines(np.asarray(2 * np.pi * np.fft.rfftfreq(period), dtype=np.float64), 1.0), 1, 2)
        deviation = float(np.sqrt(np.sum(np.var(y, axis=0, ddof=1) * inner))) / period
        return count * period * repeated_error(step, deviation)

    def steady_spectra(self, record: TimeRecord) -> tuple[ComplexArray, ComplexArray]:
        """The spectra of input and output of the steady periods, each (P, period//2 + 1)."""
        period = _period(record)
        require_changing(record)
        count = record.period_count
        if self.drop_periods is not None and count - self.drop_periods < 2:
            raise MisuseError(
                f"the record holds {count} whole periods and {self.drop_periods} are dropped; at least two must remain:"
                " record more periods or drop fewer",
                "drop_periods",
            )
        if count < 2:
            raise MisuseError("the record holds fewer than two whole periods; record at least two", "period")
        u, y = (np.fft.rfft(x[: count * period].reshape(count, period)) for x in (record.input, record.output))
        dropped = transient_periods(y - y.mean(axis=0)) if self.drop_periods is None else self.drop_periods
        return u[dropped:], y[dropped:]


def excited_lines(u: ComplexArray, threshold: float) -> BoolArray:
    """Which lines of P spectra (P, F) are excited: large against the largest line and against their own spread."""
    mean = abs(u.mean(axis=0))
    spread = np.sqrt(np.var(u, axis=0, ddof=1) / len(u)) if len(u) > 1 else np.zeros(u.shape[1])
    floor = max(threshold, 1e-13) * mean.max(initial=0.0)
    return np.asarray((mean > floor) & (mean > 4 * spread))


def transient_periods(y: ComplexArray) -> int:
    """How many leading periods of the output spectra (P, F) differ from the later half more than its noise explains."""
    count = len(y)
    half = max(2, (count + 1) // 2)
    late = y[count - half :]
    noise = np.var(late, axis=0, ddof=1)
    expected = float(np.sum(noise)) * (1 + 1 / half)
    effective = float(np.sum(noise)) ** 2 / max(float(np.sum(noise**2)) * (half - 1) / half, 1e-300)
    limit = fdtri(max(2 * effective, 1.0), max(2 * effective * (half - 1), 1.0), 0.999)
    rounding = 1e-26 * float(np.sum(abs(late) ** 2)) / half
    energy = np.sum(abs(y - late.mean(axis=0)) ** 2, axis=1)
    strange = energy[: count - half] > max(limit * expected, rounding)
    return int(np.argmin(np.append(strange, False)))


def _period(record: TimeRecord) -> int:
    if record.period is None:
        raise MisuseError(
            "the record has no period; state the samples per period or use an estimate that copes with leakage",
            "period",
        )
    return record.period


def _rounding(u: ComplexArray, y: ComplexArray, response: ComplexArray) -> FloatArray:
    """The power of rounding errors of the transforms, (F,): variances are not believed below it."""
    eps = np.finfo(np.float64).eps
    level = [float(np.mean(abs(x) ** 2)) for x in (y, u)]
    smallest = float(np.finfo(np.float64).tiny)
    return np.asarray(np.maximum(eps**2 * (level[0] + abs(response) ** 2 * level[1]), smallest))
