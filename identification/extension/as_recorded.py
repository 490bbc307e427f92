"""The output of a model at the instants at which a recorder takes its samples."""

from collections.abc import Mapping

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.clock import at_positions
from identification.effects.clock_skew import ClockSkew
from identification.extension.steady_period import batch_of_period
from identification.models.model import Model


def as_recorded(
    model: Model,
    output: FloatArray,
    sample_time: float,
    point: FloatArray,
    samples: int,
    logged: Mapping[str, float] | None = None,
) -> FloatArray:
    """y((1 + e) t) (samples,) for one period y (L,) of the output at an operating point (s,), e the skew of the clock.

    From the start of the record, where both clocks agree; without a skew the period is repeated.
    """
    found = [one for one in model.effects if isinstance(one.effect, ClockSkew)]
    if not found:
        return np.resize(output, samples)
    batch = batch_of_period(model, output, sample_time, point, logged or {})
    setting = model.setting(batch.points)
    skew = sum(float(one.amplitude(setting, batch)[0, 0]) for one in found)
    return at_positions(
        np.fft.rfft(output), len(output), np.asarray((1 + skew) * np.arange(samples, dtype=np.float64))
    )[0]
