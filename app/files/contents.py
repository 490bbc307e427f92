"""What readers make of a file: tables of named columns, in the units of the file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.errors import MisuseError

MAX_EXPANDED_BYTES = 512 * 1024 * 1024
MAX_COLUMNS = 200
MAX_MEMBERS = 100


class FileError(MisuseError):
    """The file cannot be read as a measurement; the message says what to change."""

    def __init__(self, message: str, field: str = "/file") -> None:
        super().__init__(message, field)


@dataclass(frozen=True, eq=False)
class Column:
    """One column or array: its `name` as it stands in the file, its values, and the unit that stands beside the name.

    `values`: (N,) numbers, complex numbers or texts; other shapes where a file keeps matrices. `unit`: as a line of
    units or an attribute says it, "" where only the name may say it.
    """

    name: str
    values: NDArray[Any]
    unit: str = ""


@dataclass(frozen=True, eq=False)
class Table:
    """Columns that belong together: a sheet, a structure, a group; `name` is "" where a file has only one.

    `facts`: what the file says about all of them beside its columns, by names such as sampleTimeSeconds.
    """

    columns: tuple[Column, ...]
    name: str = ""
    facts: Mapping[str, float] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(column.name for column in self.columns)

    def column(self, name: str) -> Column:
        """The column of a name; raises FileError when there is none."""
        for column in self.columns:
            if column.name == name:
                return column
        known = ", ".join(one[:40] for one in self.names)[:500]
        raise FileError(f"the file has no column or array {name[:40]!r}; it has {known}", "/columns")


def from_arrays(arrays: Mapping[str, NDArray[Any]], name: str = "") -> Table:
    """The table of named arrays."""
    return Table(tuple(Column(one, np.asarray(values)) for one, values in arrays.items()), name)


def counted(columns: int, what: str) -> None:
    """Raises FileError for more columns than are read."""
    if columns > MAX_COLUMNS:
        raise FileError(f"{what} has {columns} columns, at most {MAX_COLUMNS} are read; leave some out")
