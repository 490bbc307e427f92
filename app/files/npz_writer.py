"""npz: a zip of npy arrays, compressed."""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray


def write(arrays: dict[str, NDArray[Any]]) -> bytes:
    """The arrays as a compressed npz file."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()
