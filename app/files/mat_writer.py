"""MATLAB level 5 files of real and complex arrays, uncompressed."""

import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

INT8, INT32, UINT32, DOUBLE, MATRIX = 1, 5, 6, 9, 14
DOUBLE_CLASS, COMPLEX_FLAG = 6, 0x800
HEADER = b"MATLAB 5.0 MAT-file".ljust(116) + bytes(8) + struct.pack("<H", 0x0100) + b"IM"


def write(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Each array as a column of doubles (matrices keep their shape) under its name."""
    return HEADER + b"".join(_matrix(name, np.asarray(array)) for name, array in arrays.items())


def _matrix(name: str, array: NDArray[Any]) -> bytes:
    shape = array.shape if array.ndim >= 2 else (array.size, 1)
    is_complex = np.iscomplexobj(array)
    values = array.reshape(shape).ravel(order="F")
    parts = [
        _element(UINT32, struct.pack("<II", DOUBLE_CLASS | (COMPLEX_FLAG if is_complex else 0), 0)),
        _element(INT32, struct.pack(f"<{len(shape)}i", *shape)),
        _element(INT8, name.encode("ascii")),
        _element(DOUBLE, values.real.astype("<f8").tobytes()),
    ]
    if is_complex:
        parts.append(_element(DOUBLE, values.imag.astype("<f8").tobytes()))
    return _element(MATRIX, b"".join(parts))


def _element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)
