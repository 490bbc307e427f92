"""MATLAB level 5 files: numeric arrays, also inside structures of size one.

They are read here, with every size checked against the bytes that are there: readers made for trusted files can be
crashed by malformed ones.
"""

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files.table import MAX_EXPANDED_BYTES, MAX_MEMBERS, FileError, Table, Understand, may_be_read, named

HEADER_BYTES = 128
MAX_DEPTH = 8
MAX_ELEMENTS = 10_000
MATRIX, COMPRESSED = 14, 15
STRUCT_CLASS, NUMERIC_CLASSES = 2, range(6, 16)
NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
COMPLEX_FLAG = 0x800


def read(content: bytes, group: str = "", understand: Understand | None = None) -> Table:
    """The arrays of a file, those inside the structure `group` (such as data.measured) when it is given.

    With `understand` None, arrays that cannot be a measurement at one operating point are passed over.

    Raises FileError when the file is damaged, of another level, or holds too much.
    """
    found = dict(_Reader(_byte_order(content)).arrays(content[HEADER_BYTES:]))
    arrays = {name.rpartition(".")[2]: array for name, array in found.items() if name.rpartition(".")[0] == group}
    if not arrays:
        groups = sorted({name.rpartition(".")[0] for name in found} - {""})
        raise FileError(
            f"the mat file has no numeric arrays in {group!r}; it has some in: {', '.join(groups)[:500] or 'nothing'}"
        )
    if len(arrays) > MAX_MEMBERS:
        raise FileError(f"the mat file has {len(arrays)} arrays, at most {MAX_MEMBERS} are read")
    if understand is not None:
        return understand(arrays)
    return named({name: array for name, array in arrays.items() if may_be_read(name, array)})


def _byte_order(content: bytes) -> str:
    if content[:8] == b"\x89HDF\r\n\x1a\n" or content[:10] == b"MATLAB 7.3":
        raise FileError("MATLAB files of version 7.3 are not read; save with -v7")
    orders = {b"IM": "<", b"MI": ">"}
    mark = content[126:128]
    if len(content) < HEADER_BYTES or mark not in orders:
        raise FileError("the file is no MATLAB file of level 5; save with -v7")
    return orders[mark]


@dataclass
class _Reader:
    order: str
    expanded: int = field(default=0)
    elements: int = field(default=0)

    def arrays(self, content: bytes) -> Iterator[tuple[str, NDArray[Any]]]:
        """Names and values of the numeric arrays of a file."""
        for kind, data in self._walk(content):
            if kind == COMPRESSED:
                for inner, inflated in self._walk(self._inflated(data)):
                    if inner == MATRIX:
                        yield from self._matrix(inflated, "", 0)
            elif kind == MATRIX:
                yield from self._matrix(data, "", 0)

    def _inflated(self, data: bytes) -> bytes:
        room = MAX_EXPANDED_BYTES - self.expanded
        stream = zlib.decompressobj()
        try:
            result = stream.decompress(data, room)
        except zlib.error as error:
            raise FileError(f"the mat file is damaged: {error}") from None
        if not stream.eof:
            what = f"expands to more than {MAX_EXPANDED_BYTES} bytes" if stream.unconsumed_tail else "is cut short"
            raise FileError(f"the mat file {what}")
        self.expanded += len(result)
        return result

    def _walk(self, data: bytes) -> Iterator[tuple[int, bytes]]:
        """The elements that follow each other in `data`: their types and contents."""
        position = 0
        while position + 8 <= len(data):
            self.elements += 1
            if self.elements > MAX_ELEMENTS:
                raise FileError(f"the mat file has more than {MAX_ELEMENTS} elements")
            kind, size = struct.unpack_from(f"{self.order}II", data, position)
            if kind >> 16:
                kind, size, start, position = kind & 0xFFFF, kind >> 16, position + 4, position + 8
                if size > 4:
                    raise FileError("the mat file is damaged: a small element is too large")
            else:
                start = position + 8
                position = start + size if kind == COMPRESSED else start + -(-size // 8) * 8
            if start + size > len(data):
                raise FileError("the mat file is cut short")
            yield kind, data[start : start + size]

    def _matrix(self, data: bytes, path: str, depth: int) -> Iterator[tuple[str, NDArray[Any]]]:
        parts = list(self._walk(data))
        if not parts:
            return
        flags = int(self._numbers(parts[0])[:1].sum())
        kind, is_complex = flags & 0xFF, bool(flags & COMPLEX_FLAG)
        if kind != STRUCT_CLASS and kind not in NUMERIC_CLASSES:
            return
        if len(parts) < 3 or depth > MAX_DEPTH:
            raise FileError("the mat file is damaged, or its structures are nested too deeply")
        shape = tuple(int(n) for n in self._numbers(parts[1]))
        if not shape or min(shape) < 0:
            raise FileError("the mat file is damaged: an array has no sensible shape")
        name = path + parts[2][1].decode("latin-1")
        if kind == STRUCT_CLASS and math.prod(shape) == 1:
            yield from self._fields(parts[3:], f"{name}.", depth)
        elif kind in NUMERIC_CLASSES:
            yield name, self._values(parts[3:], shape, is_complex)

    def _fields(self, parts: list[tuple[int, bytes]], path: str, depth: int) -> Iterator[tuple[str, NDArray[Any]]]:
        if len(parts) < 2:
            raise FileError("the mat file is damaged: a structure has no fields")
        width = int(self._numbers(parts[0])[:1].sum())
        names = parts[1][1]
        count = len(names) // width if width > 0 else 0
        if count != len(parts) - 2:
            raise FileError("the mat file is damaged: a structure has not as many values as names")
        for i, (kind, data) in enumerate(parts[2:]):
            field_name = names[i * width : (i + 1) * width].partition(b"\0")[0].decode("latin-1")
            if kind == MATRIX:
                yield from self._matrix(data, path + field_name, depth + 1)

    def _values(self, parts: list[tuple[int, bytes]], shape: tuple[int, ...], is_complex: bool) -> NDArray[Any]:
        if len(parts) < 1 + is_complex:
            raise FileError("the mat file is damaged: an array has no values")
        values = self._numbers(parts[0])
        if is_complex:
            imaginary = self._numbers(parts[1])
            if len(imaginary) != len(values):
                raise FileError("the mat file is damaged: an array has not as many imaginary as real parts")
            values = np.stack([values, imaginary], axis=-1).astype(np.float64).view(np.complex128)[:, 0]
        if len(values) != math.prod(shape):
            raise FileError("the mat file is damaged: an array has not as many values as its shape says")
        return np.asarray(values).reshape(shape, order="F")

    def _numbers(self, part: tuple[int, bytes]) -> NDArray[Any]:
        kind, data = part
        if kind not in NUMBER_TYPES:
            raise FileError(f"the mat file is damaged: numbers of type {kind}")
        dtype = np.dtype(f"{self.order}{NUMBER_TYPES[kind]}")
        if len(data) % dtype.itemsize:
            raise FileError("the mat file is damaged: a part of a number")
        return np.frombuffer(data, dtype)
