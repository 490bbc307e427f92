"""Where the lines of a measurement lie on the unit circle, and how a model is brought back from there."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError, RangeError
from identification.models.system import StateSpace
from identification.signals import FrequencyResponse
from identification.subspace.time_domains import bilinear_variable, from_bilinear, from_hold, from_turned

NEARLY_EVEN = 0.1  # lines spread as evenly as this stay where they are


@dataclass(frozen=True, eq=False)
class Domain:
    """The unit circle on which a model is identified.

        discrete time:    e^{jωT} = (z + α)/(1 + αz),  −1 < α < 1
        continuous time:  jω = (2/T)(z − 1)/(z + 1)                [Akcay2008, Identification of continuous-time models]

    Both keep the frequency response, the order and the stable region. `z` (F,) are the lines, `centre` the frequency
    in rad/s that lies at z = j: amid the measured ones, since lines crowded together determine little else.
    """

    z: ComplexArray
    sample_time: float | None
    centre: float
    zero_order_hold: bool = False

    @classmethod
    def of(cls, data: FrequencyResponse, zero_order_hold: bool, centre: float | None) -> Self:
        """That of a measurement, around its median frequency where no `centre` is given.

        Raises MisuseError for a zero-order hold on continuous-time data, RangeError for a `centre` out of range.
        """
        period = data.sample_time
        if period is None and zero_order_hold:
            raise MisuseError(
                "there is no zero-order hold in a continuous-time response; state the sample time of the data, or"
                " leave the hold out",
                "zero_order_hold",
            )
        given = _amid(data) if centre is None else centre
        if not (np.isfinite(given) and given > 0 and (period is None or given < np.pi / period)):
            raise RangeError(
                f"the centre is {given} rad/s; it must be positive and below the Nyquist frequency", "centre"
            )
        if period is None:
            return cls(bilinear_variable(data.frequencies, given), None, given)
        found = cls(np.exp(1j * data.frequencies * period), period, given, zero_order_hold)
        if centre is None and abs(found.turn) < NEARLY_EVEN:
            return cls(found.z, period, np.pi / 2 / period, zero_order_hold)
        return cls((found.z - found.turn) / (1 - found.turn * found.z), period, given, zero_order_hold)

    @property
    def turn(self) -> float:
        """α; zero where the centre is half the Nyquist frequency, and in continuous time."""
        return 0.0 if self.sample_time is None else float(np.tan(np.pi / 4 - self.centre * self.sample_time / 2))

    def model(self, a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> StateSpace:
        """The model whose matrices in z these are, in the time domain asked for."""
        if self.sample_time is None:
            return from_bilinear(StateSpace(a, b, c, d, 1.0), self.centre)
        model = StateSpace(a, b, c, d, self.sample_time)
        model = from_turned(model, self.turn) if abs(self.turn) > 1e-15 else model
        return from_hold(model) if self.zero_order_hold else model


def _amid(data: FrequencyResponse) -> float:
    """The median of the frequencies between zero and the Nyquist frequency."""
    omega, period = data.frequencies, data.sample_time
    inside = omega[(omega > 0) & ((omega * (period or 0.0)) < np.pi * (1 - 1e-6))]
    if len(inside):
        return float(np.median(inside))
    return 1.0 if period is None else np.pi / 2 / period
