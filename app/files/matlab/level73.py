"""MATLAB 7.3 files, which are HDF5: variables to the same tree as those of level 5."""

import io
from typing import Any

import numpy as np

from app.files.contents import MAX_EXPANDED_BYTES, FileError

MAX_DEPTH = 8
MAX_ITEMS = 10_000
DAMAGE = (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, OverflowError, MemoryError)


def tree(content: bytes) -> dict[str, Any]:
    """The variables of a file; raises FileError when it is damaged or holds too much."""
    import h5py

    try:
        with h5py.File(io.BytesIO(content), "r") as file:
            reader = _Reader(file)
            return {name: reader.value(item, 0) for name, item in file.items() if not name.startswith("#")}
    except FileError:
        raise
    except (
        OSError,
        RuntimeError,
        KeyError,
        ValueError,
        TypeError,
        AttributeError,
        OverflowError,
        MemoryError,
    ) as error:
        raise FileError(f"the file is not a whole MATLAB file of version 7.3: {str(error)[:200]}") from None


class _Reader:
    """Follows groups (structures) and references (cells, arrays of structures), counting what it reads."""

    def __init__(self, file: Any) -> None:
        self._file = file
        self._bytes = 0
        self._items = 0

    def value(self, item: Any, depth: int) -> Any:
        """A structure as a dictionary, cells as a list, texts, and arrays with MATLAB's order of axes."""
        self._items += 1
        if depth > MAX_DEPTH or self._items > MAX_ITEMS:
            raise FileError("the mat file is nested too deeply or has too many items")
        if hasattr(item, "items"):
            return self._structure({name: self.value(inner, depth + 1) for name, inner in item.items()})
        kind = item.attrs.get("MATLAB_class", b"")
        if item.attrs.get("MATLAB_empty", 0):
            return np.zeros((0, 0))
        if item.dtype.kind == "O":
            return [self.value(self._file[one], depth + 1) for one in item[()].ravel(order="C")]
        self._bytes += item.size * item.dtype.itemsize
        if self._bytes > MAX_EXPANDED_BYTES:
            raise FileError(f"the mat file would expand to more than {MAX_EXPANDED_BYTES} bytes")
        values = item[()]
        if kind == b"char":
            return "".join(map(chr, np.asarray(values).ravel().tolist()))
        if values.dtype.names and {"real", "imag"} <= set(values.dtype.names):
            values = values["real"] + 1j * values["imag"]
        return np.asarray(values).T

    @staticmethod
    def _structure(fields: dict[str, Any]) -> Any:
        """A structure, or the list of them where every field is a list of one length."""
        lengths = {len(value) if isinstance(value, list) else -1 for value in fields.values()}
        if len(lengths) == 1 and (count := lengths.pop()) > 0:
            return [{name: value[i] for name, value in fields.items()} for i in range(count)]
        return fields
