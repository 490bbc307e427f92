"""What a model predicts for experiments whose output is not known here."""

import numpy as np

from benchmarks.cases.reading import HeldOut
from identification.arrays import ComplexArray, FloatArray
from identification.extension.as_recorded import as_recorded
from identification.extension.response import linear_response
from identification.extension.steady_period import steady_period
from identification.models.model import Model

RELEASE = 1


def predicted(model: Model, one: HeldOut) -> FloatArray | ComplexArray:
    """The output (samples,), or the response (F,) at the frequencies of the experiment.

    An input that repeats itself is answered by the steady output. One that does not is followed by as many zeros as it
    has samples and then taken as a period: the response from rest, as far as the plant settles in that time.
    """
    if one.frequencies is not None:
        return linear_response(model, [one.point], one.frequencies).response[0]
    assert one.input is not None
    if one.period is None:
        played = np.concatenate([one.input, np.zeros(RELEASE * len(one.input))])
        return _recorded(model, one, _steady(model, one, played))
    return _recorded(model, one, _steady(model, one, _one_period(one.input, one.period)))


def _recorded(model: Model, one: HeldOut, output: FloatArray) -> FloatArray:
    return as_recorded(model, output, one.sample_time, np.array(one.point), one.samples, one.logged)


def _one_period(input: FloatArray, period: int) -> FloatArray:
    """The mean of the later periods, of which the first may still be settling."""
    periods = input[: len(input) // period * period].reshape(-1, period)
    return np.asarray(periods[min(1, len(periods) - 1) :].mean(axis=0))


def _steady(model: Model, one: HeldOut, played: FloatArray) -> FloatArray:
    hold = one.hold or "band"
    found = steady_period(model, played, one.sample_time, [one.point], one.logged, covariance_known=False, hold=hold)
    return found.output[0]
