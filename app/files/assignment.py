"""Which column of a table is what: by what was said, by names and units, and by all of them together."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.files import units
from app.files.column_names import ColumnName, plain, taken_apart
from app.files.contents import Column, FileError, Table
from app.files.roles import roles_of
from app.files.statements import Said

Kind = Literal["record", "response"]
PARTS = ("response", "real", "imaginary", "magnitude", "phase")
CHOSEN = {"responseRe": "real", "responseIm": "imaginary"}


@dataclass(frozen=True, eq=False)
class Part:
    """A column with what it may be, likeliest first, its sign, and the unit it is in ("" where nothing says it)."""

    column: Column
    name: ColumnName
    roles: tuple[str, ...]
    sign: int
    unit: str
    stated: bool

    @property
    def is_complex(self) -> bool:
        """Whether its values are complex numbers."""
        return np.iscomplexobj(self.column.values)

    @property
    def is_number(self) -> bool:
        """Whether its values are numbers."""
        return self.column.values.dtype.kind in "biufc"


def parts_of(table: Table, said: Said) -> list[Part]:
    """The columns with what they may be; raises FileError when one that is spoken of is not there."""
    said.check(table)
    return [_part(column, said) for column in table.columns]


def _part(column: Column, said: Said) -> Part:
    name = taken_apart(column.name)
    unit = said.units.get(column.name) or column.unit.strip().strip("()[]{}").strip() or name.unit
    if column.name in said.roles:
        role, sign = said.roles[column.name]
        chosen = (CHOSEN.get(role, role),)
        return Part(column, name, chosen, name.sign if sign is None else sign, unit, True)
    seen = ColumnName(name.sign, name.base, unit if units.is_unit(unit) else name.unit, name.loose)
    roles = roles_of(seen)
    if not roles and name.loose:
        whole = ColumnName(name.sign, f"{name.base} {name.unit}")
        roles, unit = roles_of(whole), "" if roles_of(whole) else unit
    return Part(column, name, tuple(roles), name.sign, unit, False)


def kind_of(parts: Sequence[Part], channels: bool = False) -> Kind | None:
    """Whether columns are a record or a frequency response; None when nothing is understood.

    A frequency with all that makes a response is one, unless input and output are named as well; `channels`: matrices
    of a response were found by names such as re_y1_u1.
    """
    stated = {role for part in parts if part.stated for role in part.roles}
    if stated & {"frequency", *PARTS, "coherence", "deviation", "variance"}:
        return "response"
    if stated & {"time", "input", "output"}:
        return "record"
    named = {role for part in parts for role in part.roles}
    if {"input", "output"} <= named:
        return "record"
    if named & {"frequency", "angular"} and (
        channels or named & {"response", "magnitude"} or {"real", "imaginary"} <= named
    ):
        return "response"
    if named & {"time", "input", "output"}:
        return "record"
    return "response" if named & {"frequency", "angular"} else None


def having(parts: Iterable[Part], *roles: str) -> list[Part]:
    """The columns that may be one of these: those that were stated alone where there are any."""
    found = [part for part in parts if set(part.roles) & set(roles)]
    return [part for part in found if part.stated] or [part for part in found if not part.stated]


def only(parts: Sequence[Part], what: str) -> Part | None:
    """The single one of some columns; None when there is none; raises FileError when there are several."""
    if len(parts) > 1:
        names = ", ".join(repr(part.column.name[:40]) for part in parts)
        raise FileError(
            f"two columns or arrays of the file mean the same, the {what}: {names}; say in columns which it is, such as"
            f" {what}={parts[0].column.name[:40]}, or which are ignored"
        )
    return parts[0] if parts else None


def signals(parts: Sequence[Part], said: Said) -> tuple[Part, Part, list[str]]:
    """Input and output of a record and what is to be said about the choice; raises FileError with a question.

    What was stated goes first, then names such as u and y, the names of the plant's signals, their units, and last,
    where one of the two is known, the only other column.
    """
    notes: list[str] = []
    found = {role: _signal(parts, role, said) for role in ("input", "output")}
    for role, other in (("input", "output"), ("output", "input")):
        if found[role] is None and found[other] is not None:
            left = [part for part in _candidates(parts) if part is not found[other]]
            if len(left) == 1:
                found[role] = left[0]
                notes.append(f"The column {left[0].column.name!r} is taken as the {role}: there is no other.")
    chosen_input, chosen_output = found["input"], found["output"]
    if chosen_input is None or chosen_output is None:
        raise FileError(_question(parts, found))
    if chosen_input is chosen_output:
        raise FileError(f"{chosen_input.column.name!r} may be input or output; say which in columns", "/columns")
    return chosen_input, chosen_output, notes


def _signal(parts: Sequence[Part], role: str, said: Said) -> Part | None:
    if stated := [part for part in having(parts, role) if part.stated]:
        return only(stated, role)
    if by_plant := _like_the_plants(parts, role, said):
        return by_plant
    if named := only([part for part in having(parts, role) if _may_be(part, said.signal(role).unit)], role):
        return named
    wanted, other = said.signal(role).unit, said.signal("output" if role == "input" else "input").unit
    if not wanted or units.conversion(wanted, other) is not None:
        return None
    fitting = [part for part in _candidates(parts) if part.unit and units.conversion(part.unit, wanted) is not None]
    return fitting[0] if len(fitting) == 1 else None


def _may_be(part: Part, wanted: str) -> bool:
    """Whether the unit of a column does not speak against a signal of the plant: U in volts is no force."""
    known = units.parsed(part.unit) is not None and units.parsed(wanted) is not None and not part.name.loose
    return not known or units.conversion(part.unit, wanted) is not None


def _like_the_plants(parts: Sequence[Part], role: str, said: Said) -> Part | None:
    name = said.signal(role).name
    same = [one for one in parts if not one.stated and name and plain(name) in (one.name.plain, plain(one.column.name))]
    return same[0] if len(same) == 1 and len(plain(name)) > 0 else None


def _candidates(parts: Sequence[Part]) -> list[Part]:
    """Columns of numbers that vary, and that are neither time nor a count."""
    known = {"time", "counter", "sample_time", "sample_rate", "period", "ignored", "repeat", "reference"}
    beside = [set(part.roles) & known and not set(part.roles) & {"input", "output"} for part in parts]
    return [
        part
        for part, other in zip(parts, beside, strict=True)
        if part.is_number and part.column.values.size > 1 and not other
    ]


def _question(parts: Sequence[Part], found: dict[str, Part | None]) -> str:
    left = [part.column.name[:40] for part in _candidates(parts)]
    missing = [role for role, part in found.items() if part is None]
    if found["input"] is not None and len(left) < 2:
        return (
            "the file has an input but no output: it looks like a signal that is to be played; bring in what was"
            " measured, or say in columns which array is the output"
        )
    names = ", ".join(left)[:300] or "none"
    return (
        f"it is not clear which column is the {' and which the '.join(missing)}; say it in columns, such as"
        f" {missing[0]}={left[0] if left else 'name'}; the file has {names}"
    )
