"""Columns of tables for the entries of matrices: re_y1_u2 is the real part of output 1 over input 2."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Entry = tuple[int, int]
Entries = dict[Entry, NDArray[Any]]
MEANINGS = {"re": "real", "im": "imaginary", "var": "variance"}
_COLUMN = re.compile(r"(re|im|var)y([1-9]\d?)u([1-9]\d?)")


def entry_of(plain_name: str) -> tuple[str, Entry] | None:
    """What a column means and which entry it is, counted from one; names without case, spaces and underscores."""
    found = _COLUMN.fullmatch(plain_name)
    return None if found is None else (MEANINGS[found[1]], (int(found[2]), int(found[3])))


def assembled(columns: Mapping[Entry, NDArray[Any]]) -> NDArray[Any]:
    """The matrices (F, n_y, n_u) of their columns; raises ValueError when one is missing or of another length."""
    n_y, n_u = (max(entry[axis] for entry in columns) for axis in (0, 1))
    missing = [(y, u) for y in range(1, n_y + 1) for u in range(1, n_u + 1) if (y, u) not in columns]
    if missing:
        raise ValueError(f"that of output {missing[0][0]} and input {missing[0][1]} is missing")
    if len({len(column) for column in columns.values()}) > 1:
        raise ValueError("they differ in length")
    rows = [[columns[y, u] for u in range(1, n_u + 1)] for y in range(1, n_y + 1)]
    return np.moveaxis(np.array(rows), 2, 0)


def taken_apart(prefix: str, matrices: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """The columns of matrices (F, n_y, n_u)."""
    _, n_y, n_u = matrices.shape
    return {f"{prefix}_y{y + 1}_u{u + 1}": matrices[:, y, u] for y in range(n_y) for u in range(n_u)}
