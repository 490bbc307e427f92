"""WAV: 32-bit floating point, one channel, full scale at the peak of the signal."""

import struct

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError

FLOAT_FORMAT = 3
FACT = struct.Struct("<4sII")


def write(signal: FloatArray, sample_time: float) -> bytes:
    """The signal divided by its largest absolute value; raises RangeError unless 1/T is a whole number of Hz."""
    rate = round(1 / sample_time)
    if not 1 <= rate < 2**32 // 4 or abs(rate * sample_time - 1) > 1e-6:
        raise RangeError(
            f"WAV files need a whole number of samples a second, not {1 / sample_time:.6g}; choose another format",
            "format",
        )
    peak = float(np.max(np.abs(signal), initial=0.0))
    data = (signal / peak if peak > 0 else signal).astype("<f4").tobytes()
    description = struct.pack("<4sIHHIIHHH", b"fmt ", 18, FLOAT_FORMAT, 1, rate, 4 * rate, 4, 32, 0)
    body = b"WAVE" + description + FACT.pack(b"fact", 4, len(signal)) + struct.pack("<4sI", b"data", len(data)) + data
    return struct.pack("<4sI", b"RIFF", len(body)) + body
