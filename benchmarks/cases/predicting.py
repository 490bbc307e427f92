"""What a model predicts for experiments whose output is not known here."""

import numpy as np

from benchmarks.cases.reading import HeldOut
from identification.arrays import ComplexArray, FloatArray
from identification.extension.as_recorded import as_recorded
from identification.extension.response import linear_response
from identification.extension.steady_period import record_from_rest, steady_period
from identification.models.model import Model


def predicted(model: Model, one: HeldOut) -> FloatArray | ComplexArray:
    """The output (samples,), or the response (F,) at the frequencies of the experiment.

    An input that repeats itself is answered by the steady output, one that does not by the response from rest.
    """
    if one.frequencies is not None:
        return linear_response(model, [one.point], one.frequencies).response[0]
    assert one.input is not None
    if one.period is None:
        hold = one.hold or "band"
        found = record_from_rest(model, one.input, one.sample_time, one.point, one.logged, hold)
        return _recorded(model, one, found)
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
