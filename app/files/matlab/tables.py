"""Variables of MATLAB files to tables: structures as they are, and those that toolboxes and recorders save."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files.column_names import taken_apart
from app.files.contents import Column, Table, counted
from app.files.matlab import recordings
from app.files.roles import roles_of

Tree = Mapping[str, Any]
SHARED = {"sample_time", "sample_rate", "period"}


def tables_of(variables: Tree) -> list[Table]:
    """A table for each structure that has arrays, named by its path such as data.run(2), "" for the file itself.

    What is known of the sample time at a higher level holds for the tables below it.
    """
    found = list(_of_structure(variables, "", ()))
    found.sort(key=lambda table: table.name != "")
    return found


def _of_structure(tree: Tree, path: str, above: tuple[Column, ...]) -> Iterator[Table]:
    known = recordings.understood(tree)
    if known is not None:
        yield from (Table(table.columns, _joined(path, table.name)) for table in known)
        return
    columns = [Column(name, value) for name, value in tree.items() if _is_array(value)]
    columns += [
        Column(f"{name}{{{i + 1}}}", one)
        for name, value in tree.items()
        if isinstance(value, list)
        for i, one in enumerate(value)
        if _is_array(one)
    ]
    counted(len(columns), f"the structure {path!r}" if path else "the file")
    shared = tuple(one for one in columns if one.values.size == 1 and set(roles_of(taken_apart(one.name))) & SHARED)
    inherited = tuple(one for one in above if one.name not in {mine.name for mine in columns})
    if columns:
        yield Table((*columns, *inherited), path)
    for name, value in tree.items():
        for key, inner in _structures(name, value):
            yield from _of_structure(inner, _joined(path, key), (*shared, *inherited))


def _structures(name: str, value: Any) -> list[tuple[str, Tree]]:
    if isinstance(value, Mapping):
        return [(name, value)]
    if isinstance(value, list):
        return [(f"{name}({i + 1})", one) for i, one in enumerate(value) if isinstance(one, Mapping)]
    return []


def _joined(path: str, name: str) -> str:
    return f"{path}.{name}" if path and name else path or name


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.size > 0 and value.dtype.kind in "biufc"


def array_of(value: Any) -> NDArray[Any] | None:
    """An array of numbers, None for anything else."""
    return value if _is_array(value) else None
