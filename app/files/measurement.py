"""Tables to measurements: which columns there are decides what was measured."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.files.assignment import Part, having, kind_of, only, parts_of, signals
from app.files.contents import FileError, Table
from app.files.conversion import of_signal, radians_per_second, real, seconds
from app.files.lines import chosen_lines, label_of, split, spread
from app.files.readers import read_tables
from app.files.responses import entries_of, measured
from app.files.roles import entry_role
from app.files.sampling import Sampling, sampling
from app.files.statements import Said, Signal, said
from identification.arrays import FloatArray
from identification.signals import FrequencyResponse, Measurement, OperatingPoint, TimeRecord

Made = TypeVar("Made")
NOT_UNDERSTOOD = (
    "no column or array of the file has a name that is understood; say what they are in columns, or name them time,"
    " input, output, or frequency (Hz), responseRe, responseIm, variance; with several inputs or outputs re_y1_u1,"
    " im_y1_u1, var_y1_u1, …"
)


@dataclass(frozen=True)
class Statements:
    """What is stated beside the file, which goes before what the file says.

    `operating_point` () where `point_columns` hold it, one a scheduling variable; `variables`: names of these;
    `channels`: the plant's outputs and inputs, described by `outputs` and `inputs`; `columns`: statements such as
    input=force; `units` such as Frequency=Hz; `rows` such as run=2; `averages` behind a coherence.
    """

    operating_point: OperatingPoint
    sample_time: float | None = None
    period: int | None = None
    group: str = ""
    channels: tuple[int, int] = (1, 1)
    columns: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    rows: tuple[str, ...] = ()
    averages: int | None = None
    inputs: tuple[Signal, ...] = (Signal(),)
    outputs: tuple[Signal, ...] = (Signal(),)
    variables: tuple[str, ...] = ()
    point_columns: tuple[str, ...] | None = None

    @property
    def said(self) -> Said:
        """The statements about columns; raises MisuseError."""
        return said(self.columns, self.units, self.inputs, self.outputs)


@dataclass(frozen=True, eq=False)
class Reading:
    """A measurement in a file, with what is to be said about how it was read."""

    measurement: Measurement
    notes: tuple[str, ...] = ()


def read_measurement(content: bytes, kind: str, stated: Statements) -> Measurement:
    """The measurement in a file that a reader of this kind takes; raises MisuseError."""
    return read_measurements(content, kind, stated)[0].measurement


def read_measurements(content: bytes, kind: str, stated: Statements) -> list[Reading]:
    """The measurements in a file: one, or one for each operating point in the lines of a long table."""
    return of_tables(read_tables(content, kind), stated.group, lambda table: read_table(table, stated))


def read_table(table: Table, stated: Statements) -> list[Reading]:
    """The measurements in a table; raises MisuseError."""
    known = stated.said
    chosen = chosen_lines(spread(table), stated.rows)
    return [measurement(part, one, known) for one, part in _points(chosen, stated)]


def of_tables(tables: Sequence[Table], group: str, understood: Callable[[Table], Made]) -> Made:
    """What is understood of the table that is meant: the one named `group`, or the only one that can be understood.

    Raises FileError where several could be meant, and what is wrong with the first where none can be understood.
    """
    by_name = {table.name: table for table in tables}
    names = ", ".join(repr(name) for name in by_name if name)[:500] or "nothing"
    if group:
        if group not in by_name:
            raise FileError(f"the file has no arrays in {group[:80]!r}; it has some in: {names}", "/variableGroup")
        return understood(by_name[group])
    if len(tables) == 1:
        return understood(tables[0])
    made: dict[str, Made] = {}
    failures: list[FileError] = []
    for table in tables:
        try:
            made[table.name] = understood(table)
        except FileError as error:
            failures.append(error)
        if "" in made:
            return made[""]
    if len(made) == 1:
        return next(iter(made.values()))
    if not made:
        raise FileError(f"{failures[0] if failures else NOT_UNDERSTOOD}; the file has tables: {names}")
    several = ", ".join(repr(name) for name in made)[:500]
    raise FileError(
        f"several tables of the file could be meant: {several}; state one as variableGroup", "/variableGroup"
    )


def _points(table: Table, stated: Statements) -> list[tuple[Statements, Table]]:
    """The parts of a long table with the operating points they belong to."""
    columns = stated.point_columns
    labels = [label_of(table, name) for name in stated.variables]
    if columns is None and labels and None not in labels:
        columns = tuple(label for label in labels if label is not None)
    if columns is None:
        return [(stated, table)]
    parts = split(table, columns)
    if not stated.operating_point:
        return [(replace(stated, operating_point=point), part) for point, part in parts]
    here = [part for point, part in parts if np.allclose(point, stated.operating_point, rtol=1e-6, atol=1e-9)]
    if not here:
        known = ", ".join(str(list(point)) for point, _ in parts)[:300]
        raise FileError(f"no line of the file is of this operating point; it has {known}", "/operatingPoint")
    return [(stated, here[0])]


def measurement(table: Table, stated: Statements, known: Said | None = None) -> Reading:
    """A time record when there are input and output, a frequency response when there are frequencies."""
    known = stated.said if known is None else known
    found = {column.name: entry_role(column.name) for column in table.columns if column.name not in known.roles}
    entries = entries_of({n: (*role, table.column(n).values) for n, role in found.items() if role is not None})
    rest = replace(table, columns=tuple(column for column in table.columns if not found.get(column.name)))
    parts = [part for part in parts_of(rest, known) if part.roles != ("ignored",)]
    kind = kind_of(parts, bool(entries))
    notes: list[str] = []
    if kind is None:
        raise FileError(f"{NOT_UNDERSTOOD}; the file has {', '.join(name[:40] for name in table.names)[:300]}")
    if kind == "record":
        return _time_record(parts, table, stated, known, notes)
    return _frequency_response(parts, entries, table, stated, known, notes)


def _time_record(parts: Sequence[Part], table: Table, stated: Statements, known: Said, notes: list[str]) -> Reading:
    one, other, how = signals(parts, known)
    notes += how
    u = of_signal(one, known.signal("input"), "input", notes)
    y = of_signal(other, known.signal("output"), "output", notes)
    if u.ndim > 1 or y.ndim > 1:
        raise FileError("the input or output has several columns; choose one of each in columns, such as input=X(:,1)")
    grid = record_sampling(parts, table, stated)
    if grid.stamps is not None and len(grid.stamps) == len(u) == len(y):
        u, y = grid.on_grid(u), grid.on_grid(y)
    period = record_period(parts, stated)
    record = TimeRecord(u, y, grid.sample_time, stated.operating_point, period)
    asked = only(having(parts, "reference"), "reference")
    if asked is not None:
        r = real(asked, "reference").ravel()
        r = grid.on_grid(r) if grid.stamps is not None and len(grid.stamps) == len(r) else r
        record = replace(record, feedback=True, reference=r)
        notes.append(f"The column {asked.column.name!r} is the reference of a loop: a controller acted on the output.")
    return Reading(record, (*notes, *grid.notes))


def record_sampling(parts: Sequence[Part], table: Table, stated: Statements) -> Sampling:
    """The sampling of a record; raises FileError when there is none, or when file and statement differ."""
    time = only([part for part in having(parts, "time") if part.column.values.size > 1], "time")
    found = _file_sample_time(parts, table)
    if time is None:
        return sampling(None, found, stated.sample_time)
    return sampling(seconds(time, real(time, "time")).ravel(), found, stated.sample_time, has_unit=bool(time.unit))


def _file_sample_time(parts: Sequence[Part], table: Table) -> float | None:
    if step := only(having(parts, "sample_time"), "sample time"):
        return seconds_of(step)
    if rate := only(having(parts, "sample_rate"), "sample rate"):
        value = _scalar(replace(rate, unit=rate.unit or "Hz"), "sample rate", radians_per_second)
        return None if value is None else 2 * np.pi / value
    return table.facts.get("sampleTimeSeconds")


def seconds_of(step: Part) -> float | None:
    """A sample time in s; None where the file says 0, which is continuous time."""
    return _scalar(step, "sample time", lambda part: seconds(part, real(part, "sample time")))


def record_period(parts: Sequence[Part], stated: Statements) -> int | None:
    """The period in samples, as stated or as the file says."""
    if stated.period is not None:
        return stated.period
    part = only([part for part in having(parts, "period") if part.is_number], "period")
    value = None if part is None else _scalar(part, "period", lambda p: real(p, "period"))
    if value is not None and value != int(value):
        raise FileError("the period in the file is no whole number")
    return None if value is None else int(value)


def _frequency_response(
    parts: Sequence[Part],
    entries: dict[str, NDArray[Any]],
    table: Table,
    stated: Statements,
    known: Said,
    notes: list[str],
) -> Reading:
    double = [role for role in entries if any(part.roles[:1] == (role,) for part in parts)]
    if double:
        raise FileError(f"the file has the {double[0]} both as one array and by columns of outputs and inputs")
    _require_one_response(parts, table)
    found = measured(parts, entries, known, stated.channels, stated.averages, notes)
    degrees = only(having(parts, "degrees_of_freedom"), "degrees of freedom")
    response = FrequencyResponse(
        frequencies=found.frequencies,
        response=found.response,
        operating_point=stated.operating_point,
        sample_time=stated.sample_time if stated.sample_time is not None else _file_sample_time(parts, table),
        variance=found.noise.variance,
        variance_degrees_of_freedom=found.noise.degrees_of_freedom
        if degrees is None
        else _scalar(degrees, "degrees of freedom", lambda part: real(part, "degrees of freedom")),
    )
    return Reading(response, tuple(notes))


def _require_one_response(parts: Sequence[Part], table: Table) -> None:
    """Raises FileError where a column tells several responses apart that are not known to be repeats."""
    frequency = next(iter(having(parts, "frequency", "angular")), None)
    if frequency is None or having(parts, "repeat") or frequency.column.values.ndim != 1:
        return
    values = frequency.column.values
    if len(np.unique(values)) == len(values):
        return
    for part in parts:
        if part.roles or not _tells_apart(values, part.column.values):
            continue
        name = part.column.name[:40]
        known = ", ".join(f"{one}" for one in dict.fromkeys(part.column.values.tolist()))[:200]
        raise FileError(
            f"the file holds several responses, told apart by {name!r} ({known}); choose one with rows, such as"
            f" {name}={part.column.values[0]}, make one experiment of each with operatingPointColumns, or say that they"
            f" are repeats: columns repeat={name}",
            "/rows",
        )


def _tells_apart(frequencies: NDArray[Any], labels: NDArray[Any]) -> bool:
    """Whether labels have several values, and within each of them every frequency occurs once."""
    if labels.shape != frequencies.shape:
        return False
    groups = dict.fromkeys(labels.tolist())
    if not 1 < len(groups) <= len(frequencies) // 2:
        return False
    return all(len(np.unique(frequencies[labels == one])) == int(np.sum(labels == one)) for one in groups)


def _scalar(part: Part, what: str, convert: Callable[[Part], FloatArray]) -> float | None:
    """The one value of a column; None where it is zero and a sample time; raises FileError for others."""
    values = np.atleast_1d(convert(part)).ravel()
    if values.size and np.all(values == 0) and what == "sample time":
        return None
    if values.size == 0 or np.any(values != values[0]) or values[0] <= 0:
        raise FileError(f"the {what} in the file is not one positive number")
    return float(values[0])


def measurement_arrays(data: Measurement) -> dict[str, NDArray[Any]]:
    """The arrays that are kept of a measurement."""
    if isinstance(data, TimeRecord):
        found = {"input": data.input, "output": data.output}
        return found if data.reference is None else {**found, "reference": data.reference}
    arrays: dict[str, NDArray[Any]] = {"frequenciesRadPerSecond": data.frequencies, "response": data.response}
    return arrays if data.variance is None else {**arrays, "variance": data.variance}
