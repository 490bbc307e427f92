"""What a file would be taken for, before anything is made of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.files.assignment import Part, kind_of, parts_of, signals
from app.files.column_names import plain
from app.files.contents import FileError, Table
from app.files.lines import chosen_lines, spread
from app.files.measurement import Reading, Statements, of_tables, read_table
from app.files.readers import read_tables
from app.files.roles import entry_role
from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.signals import FrequencyResponse, TimeRecord

FIRST_ROWS = 8
MOST_POINTS = 400
MOST_COLUMNS = 60


@dataclass(frozen=True)
class ColumnView:
    """A column: name, unit, what it is taken for ("" for nothing), its sign, and its first values as texts."""

    name: str
    unit: str
    role: str
    sign: int
    values: tuple[str, ...]
    count: int


@dataclass(frozen=True, eq=False)
class Picture:
    """Curves over time in s or frequency in rad/s, thinned: names and values of each."""

    abscissa: FloatArray
    curves: tuple[tuple[str, FloatArray], ...]


@dataclass(frozen=True, eq=False)
class Preview:
    """What was seen: names of tables, the one that is meant, its columns, and what it is or why it is not yet clear."""

    tables: tuple[str, ...]
    table: str
    columns: tuple[ColumnView, ...]
    reading: Reading | None
    problem: MisuseError | None
    picture: Picture | None


def preview(content: bytes, kind: str, stated: Statements) -> Preview:
    """Look into a file; a question or a fault becomes `problem`, beside the columns as far as they could be read.

    Raises FileError when the file cannot be read at all.
    """
    tables = read_tables(content, kind)
    reading, problem, table = None, None, _meant(tables, stated)
    try:
        reading, table = of_tables(tables, stated.group, lambda one: (read_table(one, stated)[0], one))
    except MisuseError as error:
        problem = error
    return Preview(
        tuple(one.name for one in tables),
        table.name,
        tuple(_columns(table, stated))[:MOST_COLUMNS],
        reading,
        problem,
        None if reading is None else _picture(reading),
    )


def names_all(content: bytes, kind: str, group: str, names: Sequence[str]) -> bool:
    """Whether a table of the file has columns of all these names."""
    tables = [table for table in read_tables(content, kind) if group in ("", table.name)]
    return any(set(names) <= set(spread(table).names) for table in tables)


def _meant(tables: Sequence[Table], stated: Statements) -> Table:
    named = [table for table in tables if table.name == stated.group]
    return (named or sorted(tables, key=lambda table: -len(table.columns)))[0]


def _columns(table: Table, stated: Statements) -> list[ColumnView]:
    table = spread(table)
    try:
        parts = parts_of(chosen_lines(table, stated.rows), stated.said)
    except MisuseError:
        parts = parts_of(table, replace(stated, columns=(), units=()).said)
    roles = _roles(parts, stated)
    return [
        ColumnView(
            part.column.name,
            part.unit,
            role,
            part.sign,
            tuple(_written(value) for value in part.column.values.ravel()[:FIRST_ROWS]),
            int(part.column.values.size),
        )
        for part, role in zip(parts, roles, strict=True)
    ]


def _roles(parts: Sequence[Part], stated: Statements) -> list[str]:
    """What each column is taken for, as things stand."""
    kind = kind_of(parts, any(entry_role(part.column.name) for part in parts))
    roles = ["" for _ in parts]
    beside = {"time", "sample_time", "sample_rate", "period", "ignored", "counter", "repeat"}
    fitting = (
        beside if kind == "record" else {"frequency", "angular", "response", "real", "imaginary", "magnitude", "phase"}
    )
    fitting = fitting | (
        set() if kind == "record" else {"variance", "deviation", "coherence", "averages", *beside} - {"time"}
    )
    for i, part in enumerate(parts):
        roles[i] = next((role for role in part.roles if role in fitting or part.stated), "")
        roles[i] = "frequency" if roles[i] == "angular" else roles[i]
        if plain(part.column.name) in [plain(name) for name in stated.variables]:
            roles[i] = "scheduling"
    if kind == "record":
        try:
            one, other, _ = signals(parts, stated.said)
            roles = ["input" if p is one else "output" if p is other else r for p, r in zip(parts, roles, strict=True)]
        except FileError:
            pass
    return roles


def _written(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, int | float | complex | np.number) else str(value)[:40]


def _picture(reading: Reading) -> Picture:
    data = reading.measurement
    if isinstance(data, TimeRecord):
        kept = _thinned(data.output)
        time: FloatArray = np.asarray(np.arange(len(data))[kept] * data.sample_time, dtype=np.float64)
        return Picture(time, (("input", data.input[kept]), ("output", data.output[kept])))
    assert isinstance(data, FrequencyResponse), "what is no record is a response"
    order = np.argsort(data.frequencies)
    order = order[:: max(1, -(-len(order) // MOST_POINTS))]
    first = data.matrices[order, 0, 0]
    with np.errstate(divide="ignore"):
        size = np.asarray(20 * np.log10(abs(first)), dtype=np.float64)
    angle = np.asarray(np.degrees(np.unwrap(np.angle(first))), dtype=np.float64)
    frequencies: FloatArray = data.frequencies[order]
    return Picture(frequencies, (("magnitude (dB)", size), ("phase (°)", angle)))


def _thinned(samples: FloatArray) -> NDArray[np.int64]:
    """Indices of the smallest and largest sample of each stretch, so that the curve looks the same."""
    if len(samples) <= MOST_POINTS:
        return np.arange(len(samples))
    stretch = -(-2 * len(samples) // MOST_POINTS)
    starts = range(0, len(samples), stretch)
    ends = [
        (s + int(np.argmin(samples[s : s + stretch])), s + int(np.argmax(samples[s : s + stretch]))) for s in starts
    ]
    return np.unique(np.array(ends).ravel())
