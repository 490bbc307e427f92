"""What a model could have missed, whatever it is: general linear and static nonlinear directions of a record."""

from collections.abc import Iterator

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.place import Flow

LAGS = 8
MEMORIES = (0.8, 0.95, 0.99)
SHARPNESS = (0.05, 0.5)
LEVELS = (0.4, 1.0)


def general_directions(flow: Flow, first_lag: int = 0) -> ComplexArray:
    """Changes of the output (d, M, K) that missing effects are made of, whatever their names.

    Linear: the input and the model's answer delayed by samples, and filtered with three memories, q = e^{−jωT};
    forces that are smooth, even, odd or sharp in displacement and velocity; static curves at the actuator and at the
    sensor. Input delayed by less than `first_lag` samples is left out: under feedback it holds the present noise.
    """
    return np.stack([*_linear(flow, first_lag), *_nonlinear(flow)])


def _linear(flow: Flow, first_lag: int) -> Iterator[ComplexArray]:
    q = np.exp(-1j * flow.batch.omega * (flow.batch.sample_time or 1.0))
    moved, entering = flow.linear, flow.drive
    for lag in range(LAGS):
        yield moved * q ** (lag + 1)
        if lag >= first_lag:
            yield entering * q**lag
    for memory in MEMORIES:
        slow = 1 / (1 - memory * q)
        yield moved * slow * q
        yield entering * slow * q


def _nonlinear(flow: Flow) -> Iterator[ComplexArray]:
    batch, through = flow.batch, flow.response * flow.factor
    x, v, u = (_normalised(s) for s in (batch.signal(flow.core), batch.rate(flow.core), flow.input_signal()))
    for force in (*_smooth(x), *_smooth(v), *_sharp(v), *_smooth(u), *_sharp(u), *_clipped(u)):
        yield through * batch.spectrum(force)
    y = _normalised(flow.linear_signal)
    for shown in (*_smooth(y), *_clipped(y)):
        yield batch.spectrum(shown)


def _normalised(signal: FloatArray) -> FloatArray:
    size = np.sqrt(np.mean(signal**2, axis=-1, keepdims=True))
    return np.asarray(signal / np.where(size > 0, size, 1.0))


def _smooth(s: FloatArray) -> Iterator[FloatArray]:
    yield from (s * s, s * s * s, s * abs(s))


def _sharp(s: FloatArray) -> Iterator[FloatArray]:
    yield from (np.tanh(s / width) for width in SHARPNESS)


def _clipped(s: FloatArray) -> Iterator[FloatArray]:
    yield from (np.clip(s, -level, level) for level in LEVELS)
