"""What was measured at one operating point: a time record or a frequency response."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from identification.arrays import ComplexArray, FloatArray, IntArray, finite_complex, finite_floats, require_positive
from identification.channels import UNSTATED, Channels
from identification.errors import MisuseError, RangeError, ShapeError
from identification.measurements.input_errors import InputErrors

Hold = Literal["zero", "first", "band"]
OperatingPoint = tuple[float, ...]


@dataclass(frozen=True)
class HeldInput:
    """An input that keeps its value between samples (`hold` "zero"), or runs in straight lines from one to the next
    ("first"); `step` from sample to sample in seconds. Raises RangeError for a step ≤ 0.
    """

    step: float
    hold: Literal["zero", "first"] = "zero"

    def __post_init__(self) -> None:
        require_positive(self.step, "sample time")


@dataclass(frozen=True, eq=False)
class TimeRecord:
    """Input and output of one local experiment, u(t) and y(t), t = 0 … N−1, at a constant operating point.

    `input`, `output`: (N,), in the units of the plant; `sample_time` in seconds; `operating_point`: one value per
    scheduling variable; `period`: samples per period when the input repeats itself, None otherwise. `hold`: how the
    input runs between its samples: zero-order hold, first-order hold (straight lines) or band limited; None when that
    is not known. `feedback`: whether a controller acted on the output while it was recorded; `reference` (N,) the
    signal that this loop was excited with, where it was recorded.
    Raises ShapeError for unequal lengths, RangeError for values that are not finite or a sample time ≤ 0, and
    MisuseError for a reference without feedback.
    """

    input: FloatArray
    output: FloatArray
    sample_time: float
    operating_point: OperatingPoint
    period: int | None = None
    channels: Channels = UNSTATED
    hold: Hold | None = None
    feedback: bool = False
    reference: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "input", finite_floats(self.input, "input"))
        object.__setattr__(self, "output", finite_floats(self.output, "output"))
        if self.input.ndim != 1 or self.input.shape != self.output.shape:
            raise ShapeError(
                f"input has shape {self.input.shape} and output {self.output.shape}; give two vectors of one length",
                "output",
            )
        require_sampling(len(self), self.sample_time, self.period)
        if self.reference is not None:
            self._check_reference(finite_floats(self.reference, "reference"))

    def _check_reference(self, reference: FloatArray) -> None:
        if not self.feedback:
            raise MisuseError("a reference was given, but no feedback; say feedback=True or leave it out", "reference")
        if reference.shape != self.output.shape:
            raise ShapeError(
                f"the reference has shape {reference.shape} and output {self.output.shape}; give one value per sample",
                "reference",
            )
        object.__setattr__(self, "reference", reference)

    def __len__(self) -> int:
        return len(self.input)

    @property
    def period_count(self) -> int:
        """How many whole periods the record holds (1 without a period)."""
        return 1 if self.period is None else len(self) // self.period

    @property
    def held(self) -> HeldInput | None:
        """How a model in continuous time sees the input; None where it is band limited, or this is not known."""
        if self.hold == "zero" or self.hold == "first":
            return HeldInput(self.sample_time, self.hold)
        return None

    @property
    def level_known(self) -> bool:
        """Whether the levels u_0 and y_0 that belong to the operating point were both stated."""
        return self.channels.input.level is not None and self.channels.output.level is not None

    def about_its_level(self) -> "TimeRecord":
        """The record with u − u_0 and y − y_0; a level that was not stated is the mean value over the whole periods.

        What is left is what a linear model speaks of. Where the levels were not stated the mean values say nothing
        about the gain at ω = 0, which an estimator has to heed (`level_known`).
        """
        counted = len(self) if self.period is None else self.period_count * self.period
        return replace(
            self,
            input=_about(self.input, self.channels.input.level, counted),
            output=_about(self.output, self.channels.output.level, counted),
            channels=self.channels.at_level(0.0) if self.level_known else self.channels,
        )


def _about(values: FloatArray, level: float | None, counted: int) -> FloatArray:
    """Values less their level, or where it is None less the mean of the last `counted`; exactly zero where constant."""
    if level is not None:
        return values - level
    rest = values - values[0]
    return np.asarray(rest - rest[-counted:].mean())


def require_sampling(samples: int, sample_time: float, period: int | None) -> None:
    """Raises RangeError unless there are two samples or more, and sample time and period can be theirs."""
    if samples < 2:
        raise RangeError("a record needs at least two samples; record longer", "input")
    require_positive(sample_time, "sample time")
    if period is not None and not 2 <= period <= samples:
        raise RangeError(
            f"the period is {period} samples; it must lie between 2 and the record length {samples}", "period"
        )


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """A measured frequency response Ĝ(ω_k) = G(ω_k) + n_k, k = 1 … F, at a constant operating point.

    `frequencies`: (F,) rad/s, distinct, ≥ 0; `response`: (F,) with one input and one output, else (F, n_y, n_u);
    `sample_time` in seconds, None for continuous time; `variance`: shaped as `response`, E|n_k|² of circular complex
    noise (real and imaginary part have half of it each), None when unknown; `variance_degrees_of_freedom`: of its
    estimate, None when it is known exactly. With several inputs or outputs `covariance` (F, n_y n_u, n_y n_u) may say
    how the entries are correlated, E vec(n_k) vec(n_k)ᴴ, entries row by row; `variance` is then its diagonal. `held`:
    how the input ran between its samples where the response is from samples to samples and is to be that of a model in
    continuous time; None where it was band limited or sine by sine. `input_errors`: the spectra behind it where the
    input was measured with noise, or moved with that of the output, see `under`.
    Raises ShapeError for sizes that do not fit, RangeError for values that are not finite, repeated or negative
    frequencies, frequencies above the Nyquist frequency, and covariances that are not Hermitian and positive definite.
    """

    frequencies: FloatArray
    response: ComplexArray
    operating_point: OperatingPoint
    sample_time: float | None = None
    variance: FloatArray | None = None
    variance_degrees_of_freedom: float | None = None
    covariance: ComplexArray | None = None
    channels: Channels = UNSTATED
    held: HeldInput | None = None
    input_errors: InputErrors | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequencies", finite_floats(self.frequencies, "frequencies"))
        object.__setattr__(self, "response", finite_complex(self.response, "response"))
        _check_response(self.frequencies, self.response)
        _check_frequencies(self.frequencies, self.sample_time)
        if self.covariance is not None:
            covariance = finite_complex(self.covariance, "covariance")
            _check_covariance(covariance, self.response)
            object.__setattr__(self, "covariance", covariance)
            diagonal = np.diagonal(covariance, axis1=-2, axis2=-1).real
            object.__setattr__(self, "variance", diagonal.reshape(self.response.shape))
        if self.variance is not None:
            object.__setattr__(self, "variance", finite_floats(self.variance, "variance"))
            _check_variance(self.variance, self.response)

    def __len__(self) -> int:
        return len(self.frequencies)

    @property
    def matrices(self) -> ComplexArray:
        """The response as (F, n_y, n_u), whatever the number of inputs and outputs."""
        return self.response[:, None, None] if self.response.ndim == 1 else self.response

    @property
    def output_count(self) -> int:
        """n_y."""
        return int(self.matrices.shape[1])

    @property
    def input_count(self) -> int:
        """n_u."""
        return int(self.matrices.shape[2])

    def channel(self, output: int, input: int) -> "FrequencyResponse":
        """The response of one output to one input, with its variance, as a measurement of its own."""
        variance = None if self.variance is None else self.variance.reshape(self.matrices.shape)[:, output, input]
        return replace(
            self, response=self.matrices[:, output, input], variance=variance, covariance=None, input_errors=None
        )

    def under(self, response: ComplexArray) -> "FrequencyResponse":
        """The measurement as it is where the response is this one (F,): itself unless the input has errors."""
        if self.input_errors is None or self.variance is None:
            return self
        found, variance = self.input_errors.under(response)
        return replace(self, response=found, variance=variance)

    def lines(self, kept: slice | IntArray) -> "FrequencyResponse":
        """The measurement at some of its lines only."""
        variance = None if self.variance is None else self.variance[kept]
        covariance = None if self.covariance is None else self.covariance[kept]
        return replace(
            self,
            frequencies=self.frequencies[kept],
            response=self.response[kept],
            variance=variance,
            covariance=covariance,
            input_errors=None if self.input_errors is None else self.input_errors.lines(kept),
        )


Measurement = TimeRecord | FrequencyResponse


def require_one_channel(data: Measurement) -> None:
    """Raises MisuseError for a response with an axis of inputs and outputs, where a method takes one of each only."""
    if isinstance(data, FrequencyResponse) and data.response.ndim != 1:
        raise MisuseError(
            f"the response has {data.output_count} outputs and {data.input_count} inputs, this method takes one of"
            " each; give one channel at a time or use a state-space method",
            "response",
        )


def _check_response(frequencies: FloatArray, response: ComplexArray) -> None:
    if frequencies.ndim != 1 or response.ndim not in (1, 3) or response.size == 0 or len(response) != len(frequencies):
        raise ShapeError(
            f"frequencies have shape {frequencies.shape} and response {response.shape}; give one value, or one matrix"
            " of outputs × inputs, per frequency",
            "response",
        )


def _check_variance(variance: FloatArray, response: ComplexArray) -> None:
    if variance.shape != response.shape:
        raise ShapeError(
            f"the response has shape {response.shape} and variance {variance.shape}; give one variance per value",
            "variance",
        )
    if np.any(variance <= 0):
        raise RangeError("a variance is zero or negative; give positive variances or none at all", "variance")


def _check_covariance(covariance: ComplexArray, response: ComplexArray) -> None:
    count, size = len(response), response[0].size
    if response.ndim != 3 or covariance.shape != (count, size, size):
        raise ShapeError(
            f"the response has shape {response.shape} and covariance {covariance.shape}; give the variance of a single"
            " input and output, or per frequency a square matrix with one row for each entry of the response",
            "covariance",
        )
    scale = abs(covariance).max(axis=(-2, -1), keepdims=True)
    if np.any(abs(covariance - np.conj(np.swapaxes(covariance, -1, -2))) > 1e-9 * scale):
        raise RangeError("a covariance is not Hermitian; give E n nᴴ of the entries of the response", "covariance")
    if np.any(np.linalg.eigvalsh(covariance)[:, 0] <= 0):
        raise RangeError("a covariance is not positive definite; average more periods, or give variances", "covariance")


def _check_frequencies(frequencies: FloatArray, sample_time: float | None) -> None:
    if np.any(frequencies < 0):
        raise RangeError("a frequency is negative; give frequencies from zero up", "frequencies")
    if len(np.unique(frequencies)) < len(frequencies):
        raise RangeError("a frequency occurs twice; average repeated measurements first", "frequencies")
    if sample_time is None:
        return
    require_positive(sample_time, "sample time")
    if frequencies.max() > np.pi / sample_time * (1 + 1e-9):
        raise RangeError(
            f"the frequency {frequencies.max():.6g} rad/s lies above the Nyquist frequency"
            f" {np.pi / sample_time:.6g} rad/s; remove it or correct the sample time",
            "frequencies",
        )
