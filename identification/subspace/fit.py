"""How far a model is from a response, line by line."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import RangeError
from identification.models.resolvent import resolvent
from identification.signals import FrequencyResponse

EXTREME = 1e100


def response_size(data: FrequencyResponse) -> float:
    """√(1/F Σ ‖Ĝ_k‖_F²); raises RangeError where it cannot be computed with."""
    largest = float(abs(data.response).max())
    if largest == 0:
        raise RangeError("the response is zero at every frequency; check the measurement", "response")
    if not 1 / EXTREME < largest < EXTREME:
        raise RangeError(f"the response is of size {largest:.1g}; state it in other units", "response")
    return float(np.linalg.norm(data.response) / np.sqrt(len(data)))


def line_errors(
    a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray, z: ComplexArray, data: FrequencyResponse
) -> FloatArray:
    """‖Ĝ_k − G_k‖_F, (F,)."""
    return np.asarray(np.linalg.norm(data.matrices - d - resolvent(a, b, c, z), axis=(1, 2)))
