"""Where the lines of a measurement lie on the unit circle, and how a model is brought back from there."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from identification.arrays import ComplexArray
from identification.errors import MisuseError, RangeError
from identification.signals import FrequencyResponse
from identification.state_space import StateSpace
from identification.subspace.time_domains import bilinear_frequency, bilinear_variable, from_bilinear, from_hold


@dataclass(frozen=True, eq=False)
class Domain:
    """z (F,) of the lines; `centre` 2/T of the bilinear map in rad/s, None in discrete time; and what to give back."""

    z: ComplexArray
    sample_time: float | None
    centre: float | None
    zero_order_hold: bool = False

    @classmethod
    def of(cls, data: FrequencyResponse, zero_order_hold: bool, centre: float | None) -> Self:
        """e^{jωT} in discrete time, the bilinear map in continuous time.

        Raises MisuseError for a zero-order hold on continuous-time data, and for a `centre` on discrete-time data.
        """
        if data.sample_time is None:
            if zero_order_hold:
                raise MisuseError(
                    "there is no zero-order hold in a continuous-time response; state the sample time of the data, or"
                    " leave the hold out",
                    "zero_order_hold",
                )
            centre = bilinear_frequency(data.frequencies) if centre is None else centre
            if not (np.isfinite(centre) and centre > 0):
                raise RangeError(f"the centre of the bilinear map is {centre}; it must be positive", "centre")
            return cls(bilinear_variable(data.frequencies, centre), None, centre)
        if centre is not None:
            raise MisuseError("the bilinear map belongs to continuous time; leave its centre out", "centre")
        return cls(np.exp(1j * data.frequencies * data.sample_time), data.sample_time, None, zero_order_hold)

    def model(self, a: object, b: object, c: object, d: object) -> StateSpace:
        """The model whose matrices in z these are, in the time domain asked for."""
        if self.centre is not None:
            return from_bilinear(StateSpace(a, b, c, d, 1.0), self.centre)  # type: ignore[arg-type]
        model = StateSpace(a, b, c, d, self.sample_time)  # type: ignore[arg-type]
        return from_hold(model) if self.zero_order_hold else model
