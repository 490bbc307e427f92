"""Parts of a table: matrices as columns, lines that are chosen, and tables that hold several measurements."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.files.column_names import plain, taken_apart
from app.files.contents import Column, FileError, Table
from app.files.responses import MATRICES
from app.files.roles import roles_of

WIDEST = 50
SAME = 1e-9


def spread(table: Table) -> Table:
    """The table with vectors as (N,), and matrices that are no response as columns X(:,1), X(:,2), …

    Rows of a matrix are taken as samples where it has more rows than columns, else its columns.
    """
    return replace(table, columns=tuple(one for column in table.columns for one in _spread(column)))


def _spread(column: Column) -> list[Column]:
    values = np.asarray(column.values)
    if values.ndim == 0 or values.size == max(values.shape):
        return [replace(column, values=values.ravel())]
    if set(roles_of(taken_apart(column.name))) & set(MATRICES):
        return [column]
    values = np.squeeze(values)
    if values.ndim != 2 or min(values.shape) > WIDEST:
        return []
    rows = values if values.shape[0] >= values.shape[1] else values.T
    return [replace(column, name=f"{column.name}(:,{i + 1})", values=rows[:, i]) for i in range(rows.shape[1])]


def chosen_lines(table: Table, rows: Sequence[str]) -> Table:
    """The lines at which columns have the stated values, such as run=2; raises FileError when there are none."""
    for one in rows:
        name, _, value = one.rpartition("=")
        column = table.column(name)
        kept = _equal(column.values, value)
        if not kept.any():
            known = ", ".join(str(v) for v in distinct(column)[:10])
            raise FileError(f"no line has {name[:40]} = {value[:40]}; there are {known}", "/rows")
        table = lines(table, kept)
    return table


def lines(table: Table, kept: NDArray[np.bool_]) -> Table:
    """The table with some of its lines; columns of another length are left as they are."""
    return replace(
        table,
        columns=tuple(
            replace(column, values=column.values[kept]) if column.values.shape[:1] == kept.shape else column
            for column in table.columns
        ),
    )


def distinct(column: Column) -> list[float | str]:
    """The values of a column in the order in which they first come."""
    values = column.values.tolist()
    return list(dict.fromkeys(values))


def split(table: Table, names: Sequence[str]) -> list[tuple[tuple[float, ...], Table]]:
    """The parts of a table told apart by the values of some columns, with these values; raises FileError."""
    columns = [table.column(name) for name in names]
    for column in columns:
        if column.values.dtype.kind not in "biuf" or column.values.ndim != 1:
            raise FileError(
                f"{column.name[:40]!r} holds no numbers that could be operating points", "/operatingPointColumns"
            )
    if len({len(column.values) for column in columns}) > 1:
        raise FileError("the columns of the operating point differ in length", "/operatingPointColumns")
    stacked = np.column_stack([column.values.astype(np.float64) for column in columns])
    if not np.isfinite(stacked).all():
        raise FileError("a column of the operating point has a line without a number", "/operatingPointColumns")
    points, first, of = np.unique(stacked, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return [(tuple(points[i].tolist()), lines(table, of.ravel() == i)) for i in order]


def label_of(table: Table, variable: str) -> str | None:
    """The column that has the name of a scheduling variable; None when there is none, or several."""
    same = [
        column.name
        for column in table.columns
        if plain(variable) in (plain(column.name), taken_apart(column.name).plain)
        and column.values.ndim == 1
        and column.values.size > 1
    ]
    return same[0] if len(same) == 1 else None


def _equal(values: NDArray[np.generic], text: str) -> NDArray[np.bool_]:
    if values.dtype.kind not in "biuf":
        return np.array([str(one).strip() == text.strip() for one in values.ravel()])
    try:
        wanted = float(text)
    except ValueError:
        raise FileError(f"{text[:40]!r} is no number, and the column holds numbers", "/rows") from None
    return np.asarray(abs(values.astype(np.float64) - wanted) <= SAME * max(abs(wanted), 1e-300))
