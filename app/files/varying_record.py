"""Tables to records along varying scheduling: columns u, y and p, numbered where there are several."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.files.assignment import Part, kind_of, parts_of
from app.files.column_names import plain
from app.files.contents import FileError, Table
from app.files.conversion import of_signal
from app.files.lines import chosen_lines
from app.files.measurement import Statements, of_tables, record_period, record_sampling
from app.files.readers import read_tables
from app.files.statements import Said, Signal, said
from identification.arrays import FloatArray
from identification.scheduling import SchedulingVariable
from identification.varying.records import VaryingRecord

SIGNALS = {"u": "input", "y": "output", "p": "scheduling"}
_CHANNEL = re.compile(r"(u|inputs?|y|outputs?|p|scheduling)([1-9]\d?)?")
BESIDE = {"time", "sample_time", "sample_rate", "period"}


@dataclass(frozen=True)
class VaryingStatements:
    """What is stated beside the file; `columns` that hold the scheduling signals, None to find them by their names.

    `choices`: statements such as input=force about the other columns; `units`, `rows`, `inputs` and `outputs` as in
    `app.files.measurement.Statements`.
    """

    variables: tuple[SchedulingVariable, ...]
    sample_time: float | None = None
    period: int | None = None
    group: str = ""
    columns: tuple[str, ...] | None = None
    choices: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    rows: tuple[str, ...] = ()
    inputs: tuple[Signal, ...] = (Signal(),)
    outputs: tuple[Signal, ...] = (Signal(),)


@dataclass(frozen=True, eq=False)
class VaryingReading:
    """A record in a file, with what is to be said about how it was read."""

    record: VaryingRecord
    notes: tuple[str, ...] = ()


def read_varying(content: bytes, kind: str, stated: VaryingStatements) -> VaryingReading:
    """The record in a file that a reader of this kind takes; raises MisuseError."""
    known = said(stated.choices, stated.units, stated.inputs, stated.outputs)

    def understood(table: Table) -> VaryingReading:
        return _record(chosen_lines(table, stated.rows), stated, known)

    return of_tables(read_tables(content, kind), stated.group, understood)


def _record(table: Table, stated: VaryingStatements, known: Said) -> VaryingReading:
    notes: list[str] = []
    parts = [part for part in parts_of(table, known) if part.roles != ("ignored",)]
    if kind_of(parts) == "response":
        raise FileError(
            "the file holds a frequency response, for which the scheduling is held still: state its operatingPoint, or"
            " the operatingPointColumns that hold it",
            "/operatingPoint",
        )
    scheduling = _scheduling(parts, table, stated, notes)
    taken: dict[str, dict[int, FloatArray]] = {"input": {}, "output": {}, "scheduling": dict(enumerate(scheduling, 1))}
    others: list[Part] = []
    for part in parts:
        found = _channel(part, stated)
        if found is None:
            others.append(part)
            continue
        signal, number = found
        if signal == "scheduling" and scheduling:
            continue
        if number in taken[signal]:
            raise FileError(f"two columns or arrays of the file are the same channel of the {signal}")
        taken[signal][number] = _samples(part, _described(signal, number, stated), signal, notes)
    joined = {signal: _joined(signal, channels) for signal, channels in taken.items()}
    beside = [part for part in others if set(part.roles) & BESIDE]
    other = Statements((), stated.sample_time, stated.period)
    grid = record_sampling(beside, table, other)
    u, y, p = (grid.on_grid(joined[signal]) for signal in ("input", "output", "scheduling"))
    record = VaryingRecord(
        u,
        y,
        p,
        grid.sample_time,
        record_period(beside, other),
        stated.variables,
    )
    return VaryingReading(record, (*notes, *grid.notes))


def _channel(part: Part, stated: VaryingStatements) -> tuple[str, int] | None:
    """Which signal a column is and the number of its channel: as stated, by u1, y2, p …, or by the plant's names."""
    if part.stated:
        return (part.roles[0], 1) if part.roles[0] in ("input", "output") else None
    found = _CHANNEL.fullmatch(part.name.plain) or _CHANNEL.fullmatch(plain(part.column.name))
    if found is not None:
        return SIGNALS[{"i": "u", "o": "y", "s": "p"}.get(found[1][0], found[1][0])], int(found[2] or 1)
    for signal, described in (("input", stated.inputs), ("output", stated.outputs)):
        for number, one in enumerate(described, 1):
            if one.name and plain(one.name) in (part.name.plain, plain(part.column.name)):
                return signal, number
    return None


def _described(signal: str, number: int, stated: VaryingStatements) -> Signal:
    if signal == "scheduling":
        known = [Signal(one.name, one.unit) for one in stated.variables]
    else:
        known = list(stated.inputs if signal == "input" else stated.outputs)
    return known[number - 1] if number <= len(known) else Signal()


def _scheduling(parts: Sequence[Part], table: Table, stated: VaryingStatements, notes: list[str]) -> list[FloatArray]:
    """The columns that are named, or that have the names of the variables; nothing where they have neither."""
    by_column = {part.column.name: part for part in parts}
    if stated.columns is not None:
        missing = [name for name in stated.columns if name not in by_column]
        if missing:
            raise FileError(f"the file has no column or array {missing[0]!r}; it has {', '.join(table.names)[:300]}")
        found: list[Part | None] = [by_column[name] for name in stated.columns]
    else:
        by_name: dict[str, Part] = {}
        for part in parts:
            by_name |= {part.name.plain: part, plain(part.column.name): part}
        found = [by_name.get(plain(variable.name)) for variable in stated.variables]
    if None in found:
        return []
    described = [Signal(one.name, one.unit) for one in stated.variables]
    return [
        _samples(part, signal, "scheduling", notes)
        for part, signal in zip([one for one in found if one is not None], described, strict=False)
    ]


def _samples(part: Part, signal: Signal, what: str, notes: list[str]) -> FloatArray:
    """(N,) or (N, channels); rows of one number a sample, as some programs keep them, are turned."""
    values = part.column.values
    if np.iscomplexobj(values) or values.ndim > 2 or values.size == 0:
        raise FileError(f"{part.column.name[:40]!r} has shape {values.shape}; give real numbers, one row a sample")
    if values.size == max(values.shape, default=1):
        part = replace(part, column=replace(part.column, values=values.ravel()))
    return of_signal(part, signal, what, notes)


def _joined(signal: str, channels: Mapping[int, FloatArray]) -> FloatArray:
    if not channels:
        letter = next(short for short, name in SIGNALS.items() if name == signal)
        held = ", or state the operatingPoint that was held still" if signal == "scheduling" else ""
        raise FileError(
            f"the file has no {signal}; name it {signal} or {letter}, its channels {letter}1, {letter}2{held}"
        )
    if sorted(channels) != list(range(1, len(channels) + 1)):
        raise FileError(f"the channels of the {signal} are numbered {sorted(channels)}; number them from one")
    columns = [channels[i] for i in sorted(channels)]
    if len({len(column) for column in columns}) > 1:
        raise FileError(f"the channels of the {signal} differ in length")
    return np.column_stack(columns)
