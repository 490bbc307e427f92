"""Names and units above the numbers of a text, and what stands above them about the whole record."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from app.files import units
from app.files.column_names import taken_apart
from app.files.roles import roles_of
from app.files.text.cells import number
from app.files.text.layout import SEPARATORS, Layout, cells_of

_MARK = re.compile(r"^\s*(?:#+|%+|!+|//+|\*+|;+)\s*")
_WITH_UNITS = re.compile(r"\S+(?:\s*(?:\([^)]*\)|\[[^\]]*\]))?")
_WIDE = re.compile(r"\s{2,}|\t")
_FACT = re.compile(
    r"\W*(\w[^:=,;\t]*?)\s*[:=,;\t]\s*\"?([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\"?\s*[,;\t]?\s*([^\s,;\t]*)\s*[,;\t]*\s*"
)


@dataclass(frozen=True)
class Header:
    """Names of the columns, and their units where a line of its own says them; `names` None where there are none."""

    names: tuple[str, ...] | None
    units: tuple[str, ...]
    count: int | None = None


def header_of(lines: Sequence[str], layout: Layout) -> Header:
    """The names in the lines right above the numbers, which may be comments; a line of units may stand between.

    `count` is how many names there are when they do not fit the numbers.
    """
    above = [line for line in lines[: layout.start] if line.strip()][-3:]
    if not above:
        return Header(None, ())
    split = [_split(line, layout) for line in above]
    while len(split) > 1 and split[-1] is None and split[-2] is not None:
        split.pop()  # a line such as "End Comments" below the names
    nearest = split[-1]
    if nearest is None:
        count = len(cells_of(_MARK.sub("", above[-1]), layout.separator))
        return Header(None, (), count if count > 1 and layout.start == 1 else None)
    before = split[-2] if len(split) > 1 else None
    if before is not None and _are_units(nearest) and not _are_units(before):
        return Header(_cleaned(before), tuple(_unit(cell) for cell in nearest))
    return Header(_cleaned(nearest), ())


def _split(line: str, layout: Layout) -> list[str] | None:
    """A line as as many cells as the numbers have, by their separator or by another one."""
    text = _MARK.sub("", line.rstrip("\r\n"))
    for candidate in (line.rstrip("\r\n"), text):
        for separator in (layout.separator, *SEPARATORS[:-1]):
            if separator != " " and len(cells := cells_of(candidate, separator)) == layout.width:
                return cells
    for cells in (_WIDE.split(text.strip()), _WITH_UNITS.findall(text), text.split()):
        if len(cells) == layout.width:
            return cells
    trimmed = [cell for cell in cells_of(text, layout.separator) if cell.strip()]
    return trimmed if len(trimmed) == layout.width else None


def _cleaned(cells: Sequence[str]) -> tuple[str, ...]:
    return tuple(cell.strip().strip('"').strip() for cell in cells)


def _are_units(cells: Sequence[str]) -> bool:
    """Whether all that stands in a line is units, in brackets or without."""
    filled = [cell.strip().strip('"') for cell in cells if cell.strip().strip('"')]
    known = [
        _unit(cell) in ("", "#") or units.is_unit(_unit(cell)) or cell[0] + cell[-1] in ("()", "[]") for cell in filled
    ]
    return bool(filled) and all(known)


def _unit(cell: str) -> str:
    return cell.strip().strip('"').strip().strip("()[]{}").strip()


def facts_of(lines: Sequence[str], mark: str) -> dict[str, float]:
    """What lines above the numbers say of the record, such as "Sampling rate: 1 kHz" or "# dt = 0.01"."""
    facts: dict[str, float] = {}
    for line in lines:
        found = _FACT.fullmatch(line.strip())
        value = None if found is None else number(found[2].strip(".,"), mark)
        if found is None or value is None or isinstance(value, complex) or not value > 0:
            continue
        name = taken_apart(found[1])
        unit = found[3].strip("()[]") or name.unit
        roles = roles_of(name)
        if "sample_time" in roles and (factor := units.conversion(unit or "s", "s")):
            facts.setdefault("sampleTimeSeconds", value * factor[0])
        elif "sample_rate" in roles and (factor := units.conversion(unit or "Hz", "Hz")):
            facts.setdefault("sampleTimeSeconds", 1 / (value * factor[0]))
        elif "averages" in roles:
            facts.setdefault("averages", value)
    return facts
