"""Tables to records along varying scheduling: columns u, y and p, numbered where there are several."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files import csv_file, mat_file, npz_file
from app.files.column_choice import Members, renamed
from app.files.measurement import Statements, record_period, record_sample_time
from app.files.table import FileError, Table, named, numbers, plain
from identification.arrays import FloatArray
from identification.scheduling import SchedulingVariable
from identification.varying.records import VaryingRecord

SIGNALS = {"u": "input", "y": "output", "p": "scheduling"}
_CHANNEL = re.compile(r"(u|inputs?|y|outputs?|p|scheduling)([1-9]\d?)?")


@dataclass(frozen=True)
class VaryingStatements:
    """What is stated beside the file; `columns` that hold the scheduling signals, None to find them by their names.

    `choices`: statements such as input=force about the other columns.
    """

    variables: tuple[SchedulingVariable, ...]
    sample_time: float | None = None
    period: int | None = None
    group: str = ""
    columns: tuple[str, ...] | None = None
    choices: tuple[str, ...] = ()


def read_varying(content: bytes, file_format: str, stated: VaryingStatements) -> VaryingRecord:
    """The record in a file of format csv, npz or mat; raises MisuseError."""

    def understand(members: Members) -> Table:
        return varying_table(renamed(members, stated.choices), stated)

    readers: dict[str, Callable[[], Table]] = {
        "csv": lambda: csv_file.read(content, understand),
        "npz": lambda: npz_file.read(content, understand),
        "mat": lambda: mat_file.read(content, stated.group, understand),
    }
    table = readers[file_format]()
    for name, values in table.items():
        bad = np.argwhere(~np.isfinite(np.atleast_1d(values)))
        if bad.size:
            raise FileError(f"the {name} has a value at position {bad[0][0]} that is not a finite number")
    other = Statements((), stated.sample_time, stated.period)
    return VaryingRecord(
        table["input"],
        table["output"],
        table["scheduling"],
        record_sample_time(table, other),
        record_period(table, other),
        stated.variables,
    )


def varying_table(members: Mapping[str, NDArray[Any]], stated: VaryingStatements) -> Table:
    """Input, output and scheduling as (N, channels), and what else is understood; raises FileError."""
    scheduling = _scheduling(members, stated)
    taken: dict[str, dict[int, FloatArray]] = {"input": {}, "output": {}, "scheduling": dict(enumerate(scheduling, 1))}
    rest: dict[str, NDArray[Any]] = {}
    for name, array in members.items():
        found = _CHANNEL.fullmatch(plain(name))
        if found is None:
            rest[name] = array
            continue
        signal = SIGNALS[{"i": "u", "o": "y", "s": "p"}.get(found[1][0], found[1][0])]
        if signal == "scheduling" and scheduling:
            continue
        if int(found[2] or 1) in taken[signal]:
            raise FileError(f"two columns or arrays of the file are the same channel of the {signal}")
        taken[signal][int(found[2] or 1)] = _samples(name, array)
    table = {signal: _joined(signal, channels) for signal, channels in taken.items()}
    others = {name: array for name, array in rest.items() if plain(name) in _BESIDE}
    return {**table, **(named(others) if others else {})}


_BESIDE = {"time", "t", "timeseconds", "sampletimeseconds", "sampletime", "ts", "dt", "periodsamples", "period"}


def _scheduling(members: Mapping[str, NDArray[Any]], stated: VaryingStatements) -> list[FloatArray]:
    """The columns that are named, or that have the names of the variables; nothing where they have neither."""
    if stated.columns is not None:
        missing = [name for name in stated.columns if name not in members]
        if missing:
            raise FileError(f"the file has no column or array {missing[0]!r}; it has {', '.join(members)[:300]}")
        return [_samples(name, members[name]) for name in stated.columns]
    by_name = {plain(name): name for name in members}
    names = [by_name.get(plain(variable.name)) for variable in stated.variables]
    return [] if None in names else [_samples(name, members[name]) for name in names if name is not None]


def _samples(name: str, array: NDArray[Any]) -> FloatArray:
    """(N,) or (N, channels); rows of one number a sample, as some programs keep them, are turned."""
    values = numbers(name, array)
    if np.iscomplexobj(values) or values.ndim > 2 or values.size == 0:
        raise FileError(f"{name[:40]!r} has shape {array.shape}; give real numbers, one row a sample")
    values = values.astype(np.float64)
    return values.ravel() if values.size == max(values.shape, default=1) else values


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
