"""What was measured at one operating point: a time record or a frequency response."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray, finite_complex, finite_floats
from identification.errors import RangeError, ShapeError

OperatingPoint = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class TimeRecord:
    """Input and output of one local experiment, u(t) and y(t), t = 0 … N−1, at a constant operating point.

    `input`, `output`: (N,), in the units of the plant; `sample_time` in seconds; `operating_point`: one value per
    scheduling variable; `period`: samples per period when the input repeats itself, None otherwise.
    Raises ShapeError for unequal lengths and RangeError for values that are not finite or a sample time ≤ 0.
    """

    input: FloatArray
    output: FloatArray
    sample_time: float
    operating_point: OperatingPoint
    period: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "input", finite_floats(self.input, "input"))
        object.__setattr__(self, "output", finite_floats(self.output, "output"))
        if self.input.ndim != 1 or self.input.shape != self.output.shape:
            raise ShapeError(
                f"input has shape {self.input.shape} and output {self.output.shape}; give two vectors of one length",
                "output",
            )
        if len(self) < 2:
            raise RangeError("a record needs at least two samples; record longer", "input")
        if not (np.isfinite(self.sample_time) and self.sample_time > 0):
            raise RangeError(f"the sample time is {self.sample_time}; it must be positive", "sample_time")
        if self.period is not None and not 2 <= self.period <= len(self):
            raise RangeError(
                f"the period is {self.period} samples; it must lie between 2 and the record length {len(self)}",
                "period",
            )

    def __len__(self) -> int:
        return len(self.input)

    @property
    def period_count(self) -> int:
        """How many whole periods the record holds (1 without a period)."""
        return 1 if self.period is None else len(self) // self.period


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """A measured frequency response Ĝ(ω_k) = G(ω_k) + n_k, k = 1 … F, at a constant operating point.

    `frequencies`: (F,) rad/s, distinct, ≥ 0; `response`: (F,); `sample_time` in seconds, None for continuous time;
    `variance`: (F,) E|n_k|² of circular complex noise (real and imaginary part have half of it each), None when
    unknown; `variance_degrees_of_freedom`: of its estimate, None when it is known exactly.
    """

    frequencies: FloatArray
    response: ComplexArray
    operating_point: OperatingPoint
    sample_time: float | None = None
    variance: FloatArray | None = None
    variance_degrees_of_freedom: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequencies", finite_floats(self.frequencies, "frequencies"))
        object.__setattr__(self, "response", finite_complex(self.response, "response"))
        _check_same_length(self.frequencies, self.response, "response")
        _check_frequencies(self.frequencies, self.sample_time)
        if self.variance is not None:
            object.__setattr__(self, "variance", finite_floats(self.variance, "variance"))
            _check_same_length(self.frequencies, self.variance, "variance")
            if np.any(self.variance <= 0):
                raise RangeError("a variance is zero or negative; give positive variances or none at all", "variance")

    def __len__(self) -> int:
        return len(self.frequencies)


Measurement = TimeRecord | FrequencyResponse


def _check_same_length(frequencies: FloatArray, values: FloatArray | ComplexArray, field: str) -> None:
    if frequencies.ndim != 1 or values.shape != frequencies.shape or len(frequencies) == 0:
        raise ShapeError(
            f"frequencies have shape {frequencies.shape} and {field} {values.shape}; give one value per frequency",
            field,
        )


def _check_frequencies(frequencies: FloatArray, sample_time: float | None) -> None:
    if np.any(frequencies < 0):
        raise RangeError("a frequency is negative; give frequencies from zero up", "frequencies")
    if len(np.unique(frequencies)) < len(frequencies):
        raise RangeError("a frequency occurs twice; average repeated measurements first", "frequencies")
    if sample_time is not None and not (np.isfinite(sample_time) and sample_time > 0):
        raise RangeError(f"the sample time is {sample_time}; it must be positive", "sample_time")
    if sample_time is not None and frequencies.max() > np.pi / sample_time * (1 + 1e-9):
        raise RangeError(
            f"the frequency {frequencies.max():.6g} rad/s lies above the Nyquist frequency"
            f" {np.pi / sample_time:.6g} rad/s; remove it or correct the sample time",
            "frequencies",
        )
