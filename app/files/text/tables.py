"""Texts to tables: one after another where a text holds several."""

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from app.files.contents import Column, FileError, Table, counted
from app.files.text.cells import column, is_gap, is_stamp, number
from app.files.text.header import Header, facts_of, header_of
from app.files.text.layout import COMMENTS, Layout, cells_of, layout_of


def tables_of(text: str) -> list[Table]:
    """The tables of numbers in a text; raises FileError when there are none, or when one has a line of another form."""
    lines = text.splitlines()
    if not text.strip().strip("\ufeff"):
        raise FileError("the file is empty")
    found: list[Table] = []
    facts: dict[str, float] = {}
    begin = 0
    while (layout := layout_of(lines[begin:])) is not None:
        here = lines[begin:]
        end, body = _body(here, layout, begin)
        facts = {**facts_of(here[: layout.start], layout.mark), **facts}
        found.append(_table(here, layout, body, facts, len(found)))
        begin += end
    if not found:
        raise FileError("the file is not a table of numbers: no line has two numbers or more")
    return found if len(found) > 1 else [Table(found[0].columns, "", found[0].facts)]


def _body(lines: Sequence[str], layout: Layout, begin: int) -> tuple[int, list[str]]:
    """The lines of numbers from the start of a table, and where it ends."""
    body: list[str] = []
    for index in range(layout.start, len(lines)):
        line = lines[index]
        if not line.strip() or line.lstrip().startswith(COMMENTS):
            continue
        cells = cells_of(line, layout.separator)
        width = len(cells)
        numbers = sum(not is_gap(cell) and number(cell, layout.mark) is not None for cell in cells)
        if numbers == 0 and not all(is_gap(cell) for cell in cells):
            return index, body
        if width != layout.width and len([c for c in cells if c.strip()]) != layout.width:
            raise FileError(
                f"the file is not a table of numbers: line {begin + index + 1} has {width} values, line"
                f" {begin + layout.start + 1} has {layout.width}"
            )
        body.append(line)
    return len(lines), body


def _table(lines: Sequence[str], layout: Layout, body: Sequence[str], facts: dict[str, float], number_of: int) -> Table:
    values = _fast(body, layout)
    columns = list(values.T) if values is not None else _slow(body, layout, lines)
    header = header_of(lines, layout)
    names = _names(header, layout)
    counted(len(names), "the file")
    units = header.units or ("",) * layout.width
    kept = [
        Column(name, one, unit)
        for name, one, unit in zip(names, columns, units, strict=True)
        if not (one.dtype.kind == "f" and np.all(np.isnan(one)))
    ]
    if len({one.name for one in kept}) < len(kept):
        raise FileError("two columns of the file have the same name; give each its own")
    return Table(tuple(kept), f"table {number_of + 1}", facts)


def _names(header: Header, layout: Layout) -> tuple[str, ...]:
    if header.names is None:
        if header.count is not None and header.count != layout.width:
            raise FileError(f"the header has {header.count} names, the lines have {layout.width} values")
        return tuple(f"column {i + 1}" for i in range(layout.width))
    return tuple(name or f"column {i + 1}" for i, name in enumerate(header.names))


def _fast(body: Sequence[str], layout: Layout) -> NDArray[np.float64] | None:
    """All numbers at once where the lines are plain; None where they need more care."""
    text = "\n".join(body)
    if '"' in text or (layout.mark == "," and "." in text):
        return None
    text = text.replace(",", ".") if layout.mark == "," else text
    try:
        values = np.loadtxt(
            io.StringIO(text), delimiter=None if layout.separator == " " else layout.separator, ndmin=2, comments=None
        )
    except ValueError:
        return None
    return values if values.shape[1] == layout.width else None


def _slow(body: Sequence[str], layout: Layout, lines: Sequence[str]) -> list[NDArray[np.generic]]:
    rows = [cells_of(line, layout.separator) for line in body]
    rows = [row if len(row) == layout.width else [cell for cell in row if cell.strip()] for row in rows]
    result = [column([row[i] for row in rows], layout.mark) for i in range(layout.width)]
    for i, values in enumerate(result):
        if values.dtype.kind == "U":
            _require_text([row[i] for row in rows], layout, i)
    return result


def _require_text(cells: Sequence[str], layout: Layout, index: int) -> None:
    """Raises FileError for a column of numbers with some cells that are none."""
    bad = [cell for cell in cells if number(cell, layout.mark) is None and not is_stamp(cell)]
    if 2 * len(bad) < len(cells) or (number(cells[0], layout.mark) is not None and not is_gap(cells[0])):
        raise FileError(
            f"the file is not a table of numbers: column {index + 1} has {bad[0].strip()[:40]!r} where a number is"
            " expected; correct it, or leave the line out"
        )
