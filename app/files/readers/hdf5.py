"""HDF5 files: groups as tables, datasets as columns, with units from attributes."""

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from app.files.contents import MAX_EXPANDED_BYTES, Column, FileError, Table, counted
from app.files.reader import Reader

MAX_DEPTH = 8
MAX_ITEMS = 10_000
UNITS = ("unit", "units", "Unit", "Units", "UNIT")
DAMAGE = (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, OverflowError, MemoryError)


class Hdf5File(Reader):
    """Datasets of numbers in groups; compound datasets give a column a field."""

    kind = "hdf5"
    title = "HDF5 file"
    endings = ("h5", "hdf5", "hdf")

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        import h5py

        try:
            with h5py.File(io.BytesIO(content), "r") as file:
                found = list(_Walk().tables(file, "", 0))
        except FileError:
            raise
        except DAMAGE as error:
            raise FileError(f"the file is not a whole HDF5 file: {str(error)[:200]}") from None
        if not found:
            raise FileError("the HDF5 file has no datasets of numbers")
        return found

    @classmethod
    def example(cls) -> bytes:
        import h5py

        buffer = io.BytesIO()
        with h5py.File(buffer, "w") as file:
            group = file.create_group("run1")
            for name, unit, values in (("time", "ms", 5.0 * np.arange(8)), ("u", "V", np.arange(8.0) % 3 - 1)):
                group[name] = values
                group[name].attrs["unit"] = unit
            group["y"] = 0.25 * np.arange(8)
        return buffer.getvalue()


class _Walk:
    """Goes through the groups, counting what it reads."""

    def __init__(self) -> None:
        self._bytes = self._items = 0

    def tables(self, group: Any, path: str, depth: int) -> Iterator[Table]:
        if depth > MAX_DEPTH:
            raise FileError("the HDF5 file is nested too deeply")
        columns: list[Column] = []
        inner = []
        for name, item in group.items():
            self._items += 1
            if self._items > MAX_ITEMS:
                raise FileError(f"the HDF5 file has more than {MAX_ITEMS} items")
            if hasattr(item, "items"):
                inner.append((name, item))
            else:
                columns += self._columns(name, item)
        counted(len(columns), f"the group {path!r}")
        if columns:
            yield Table((*columns, *_attributes(group)), path)
        for name, item in inner:
            yield from self.tables(item, f"{path}/{name}" if path else name, depth + 1)

    def _columns(self, name: str, item: Any) -> list[Column]:
        self._bytes += item.size * item.dtype.itemsize
        if self._bytes > MAX_EXPANDED_BYTES:
            raise FileError(f"the HDF5 file would expand to more than {MAX_EXPANDED_BYTES} bytes")
        unit = next((str(_plain(item.attrs[key])) for key in UNITS if key in item.attrs), "")
        if item.dtype.names and set(item.dtype.names) != {"r", "i"}:
            values = item[()]
            return [
                Column(key, np.asarray(values[key])) for key in item.dtype.names if values[key].dtype.kind in "biuf"
            ]
        if item.dtype.kind not in "biufc" or item.size == 0:
            return []
        return [Column(name, np.asarray(item[()]), unit)]


def _plain(value: Any) -> Any:
    value = value[0] if isinstance(value, np.ndarray) and value.size else value
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def _attributes(group: Any) -> list[Column]:
    """Numbers among the attributes of a group, such as its sample time."""
    found = {name: np.asarray(value) for name, value in group.attrs.items()}
    return [
        Column(name, value.ravel()) for name, value in found.items() if value.dtype.kind in "iuf" and value.size == 1
    ]
