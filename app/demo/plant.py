"""The simulated plant of the demonstration: an air heater in a duct. It shares no code with the models."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray

RUN_IN = 200  # seconds of draught before the heater is touched


@dataclass(frozen=True)
class AirHeater:
    """A duct heater, once a second, at a constant air velocity v in m/s between 0 and 8.

    T is the deviation of the outlet temperature in K from its working point, P that of the heater's power in kW; slow
    and strong in still air, fast and weak in a gale. A draught δ with a memory of its own disturbs what is measured:

        T(t+1) = (0.9 − 0.1 v) T(t) + (10 − v) P(t),   δ(t) = (0.7 − 0.08 v) δ(t−1) + e(t),   y(t) = T(t) + δ(t)

    e is white with a variance of `shock_variance` K². These are the numbers of the example in [Ghosh2018, Section 5].
    """

    shock_variance: float = 0.5

    def measure(self, velocity: float, power: FloatArray, generator: np.random.Generator) -> FloatArray:
        """The measured temperature (N,) while `power` (N,) is played, beginning at the working point."""
        keeps, heats, remembers = 0.9 - 0.1 * velocity, 10 - velocity, 0.7 - 0.08 * velocity
        shocks = generator.normal(0.0, self.shock_variance**0.5, RUN_IN + len(power))
        draught = 0.0
        for shock in shocks[:RUN_IN]:
            draught = remembers * draught + shock
        temperature, measured = 0.0, np.empty(len(power))
        for t, shock in enumerate(shocks[RUN_IN:]):
            draught = remembers * draught + shock
            measured[t] = temperature + draught
            temperature = keeps * temperature + heats * power[t]
        return measured
