"""WAV: 32-bit floating point, one channel, full scale at the peak of the signal, which a comment states."""

import struct

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError

FLOAT_FORMAT = 3
FACT = struct.Struct("<4sII")


def write(signal: FloatArray, sample_time: float) -> bytes:
    """The signal divided by its largest absolute value, which the comment (LIST INFO ICMT) states.

    Raises RangeError unless 1/T is a whole number of Hz.
    """
    rate = round(1 / sample_time)
    if not 1 <= rate < 2**32 // 4 or abs(rate * sample_time - 1) > 1e-6:
        raise RangeError(
            f"WAV files need a whole number of samples a second, not {1 / sample_time:.6g}; choose another format",
            "format",
        )
    peak = float(np.max(np.abs(signal), initial=0.0))
    data = (signal / peak if peak > 0 else signal).astype("<f4").tobytes()
    description = struct.pack("<4sIHHIIHHH", b"fmt ", 18, FLOAT_FORMAT, 1, rate, 4 * rate, 4, 32, 0)
    fact = FACT.pack(b"fact", 4, len(signal))
    comment = _comment(f"full scale (1.0) is {peak:.9g} in the unit of the input")
    body = b"WAVE" + description + fact + comment + struct.pack("<4sI", b"data", len(data)) + data
    return struct.pack("<4sI", b"RIFF", len(body)) + body


def _comment(text: str) -> bytes:
    content = text.encode("ascii") + b"\0"
    content += b"\0" * (len(content) % 2)
    return struct.pack("<4sI4s4sI", b"LIST", 12 + len(content), b"INFO", b"ICMT", len(content)) + content
