"""MATLAB level 5 files: numbers and texts, also inside structures, cells and objects of the old kind.

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

from app.files.contents import MAX_EXPANDED_BYTES, FileError

HEADER_BYTES = 128
MAX_DEPTH = 8
MAX_ELEMENTS = 100_000
MATRIX, COMPRESSED = 14, 15
CELL_CLASS, STRUCT_CLASS, OBJECT_CLASS, CHAR_CLASS, NUMERIC_CLASSES = 1, 2, 3, 4, range(6, 16)
STRUCT_CLASSES = (STRUCT_CLASS, OBJECT_CLASS)
NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
COMPLEX_FLAG = 0x800


def tree(content: bytes) -> dict[str, Any]:
    """The variables of a file: arrays, texts, lists (cells and arrays of structures) and dictionaries (structures).

    Raises FileError when the file is damaged, of another level, or holds too much.
    """
    return dict(_Reader(_byte_order(content)).variables(content[HEADER_BYTES:]))


def _byte_order(content: bytes) -> str:
    orders = {b"IM": "<", b"MI": ">"}
    mark = content[126:128]
    if len(content) < HEADER_BYTES or mark not in orders:
        raise FileError("the file is no MATLAB file of level 5 or 7.3; save with -v7 or -v7.3")
    return orders[mark]


@dataclass
class _Reader:
    order: str
    expanded: int = field(default=0)
    elements: int = field(default=0)

    def variables(self, content: bytes) -> Iterator[tuple[str, Any]]:
        """Names and values of the variables of a file."""
        for kind, data in self._walk(content):
            if kind == COMPRESSED:
                for inner, inflated in self._walk(self._inflated(data)):
                    if inner == MATRIX:
                        yield from self._named(inflated)
            elif kind == MATRIX:
                yield from self._named(data)

    def _named(self, data: bytes) -> Iterator[tuple[str, Any]]:
        found = self._matrix(data, 0)
        if found is not None and found[0]:
            yield found

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

    def _matrix(self, data: bytes, depth: int) -> tuple[str, Any] | None:
        """Name and value of an array; None for what is empty or of a class that is not read, such as objects."""
        parts = list(self._walk(data))
        if not parts:
            return None
        flags = int(self._numbers(parts[0])[:1].sum())
        kind, is_complex = flags & 0xFF, bool(flags & COMPLEX_FLAG)
        if kind not in (*STRUCT_CLASSES, CELL_CLASS, CHAR_CLASS, *NUMERIC_CLASSES):
            return None
        if len(parts) < 3 or depth > MAX_DEPTH:
            raise FileError("the mat file is damaged, or its structures are nested too deeply")
        shape = tuple(int(n) for n in self._numbers(parts[1]))
        if not shape or min(shape) < 0:
            raise FileError("the mat file is damaged: an array has no sensible shape")
        name = parts[2][1].decode("latin-1")
        if kind in STRUCT_CLASSES:
            return name, self._structures(parts[3 + (kind == OBJECT_CLASS) :], math.prod(shape), depth)
        if kind == CELL_CLASS:
            inner = [self._matrix(one, depth + 1) for what, one in parts[3:] if what == MATRIX]
            return name, [None if one is None else one[1] for one in inner]
        if kind == CHAR_CLASS:
            return name, self._text(parts[3:], shape)
        return name, self._values(parts[3:], shape, is_complex)

    def _structures(self, parts: list[tuple[int, bytes]], count: int, depth: int) -> Any:
        """The fields of a structure, or the list of those of an array of structures."""
        if len(parts) < 2:
            raise FileError("the mat file is damaged: a structure has no fields")
        width = int(self._numbers(parts[0])[:1].sum())
        names = parts[1][1]
        fields = len(names) // width if width > 0 else 0
        if fields * count != len(parts) - 2:
            raise FileError("the mat file is damaged: a structure has not as many values as names")
        texts = [names[i * width : (i + 1) * width].partition(b"\0")[0].decode("latin-1") for i in range(fields)]
        made: list[dict[str, Any]] = []
        for i in range(count):
            values = [self._matrix(one, depth + 1) for _, one in parts[2 + i * fields : 2 + (i + 1) * fields]]
            made.append({text: value[1] for text, value in zip(texts, values, strict=True) if value is not None})
        return made[0] if count == 1 else made

    def _text(self, parts: list[tuple[int, bytes]], shape: tuple[int, ...]) -> str:
        if not parts:
            return ""
        kind, data = parts[0]
        encodings = {16: "utf-8", 17: "utf-16-le" if self.order == "<" else "utf-16-be"}
        if kind in encodings:
            return data.decode(encodings[kind], "replace")
        codes = self._numbers(parts[0]).astype(np.int64)
        if len(codes) != math.prod(shape):
            raise FileError("the mat file is damaged: a text has not as many letters as its shape says")
        return "".join(map(chr, codes[(codes > 0) & (codes < 0x110000)].tolist()))

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
