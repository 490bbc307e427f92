"""How a text is laid out as a table: separator, decimal mark, where the numbers begin."""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

from app.files.text.cells import is_gap, is_stamp, number

SEPARATORS = ("\t", ";", ",", "|", " ")
MARKS = (".", ",")
COMMENTS = ("#", "%", "!", "//")
LOOKED_AT = 1500
_BLANKS = re.compile(r"\s+")


@dataclass(frozen=True)
class Layout:
    """Separator (" " for any blanks), decimal mark, and the index of the first line of numbers."""

    separator: str
    mark: str
    start: int
    width: int


def cells_of(line: str, separator: str) -> list[str]:
    """The cells of a line; quotes may hold separators."""
    if separator == " ":
        return _BLANKS.split(line.strip())
    if '"' in line:
        return next(csv.reader([line], delimiter=separator), [])
    return line.split(separator)


def layout_of(lines: Sequence[str]) -> Layout | None:
    """The layout under which most cells of one run of lines are numbers; None when there are no lines of numbers.

    Each separator is tried with each decimal mark (a comma is one or the other, unless cells stand in quotes); cells
    that are no numbers count against it. Of equals the first is taken: tab, semicolon, comma, bar, blanks; the point.
    """
    best: tuple[float, Layout] | None = None
    for separator in SEPARATORS:
        for mark in MARKS:
            found = _tried(lines[:LOOKED_AT], separator, mark)
            if found is not None and (best is None or found[0] > best[0]):
                best = found
    return None if best is None else best[1]


def _tried(lines: Sequence[str], separator: str, mark: str) -> tuple[float, Layout] | None:
    """Score and layout of the longest run of lines of numbers."""
    best: tuple[float, Layout] | None = None
    start, width, score, length = 0, 0, 0.0, 0
    for index, line in enumerate(lines):
        if not line.strip() or line.lstrip().startswith(COMMENTS):
            continue
        cells = cells_of(line, separator)
        if all(is_gap(cell) for cell in cells):
            continue
        worth = _worth(cells, mark)
        if worth <= 0 or (separator == "," and mark == "," and '"' not in line):
            width = 0
            continue
        if len(cells) != width:
            start, width, score, length = index, len(cells), 0.0, 0
        score, length = score + worth, length + 1
        if width > 1 and (best is None or score > best[0]):
            best = (score, Layout(separator, mark, start, width))
    return best


def _worth(cells: Sequence[str], mark: str) -> int:
    """Cells that are numbers less those that are not, gaps and clock times counting nothing; 0 without a number."""
    filled = [cell for cell in cells if not is_gap(cell)]
    numbers = sum(number(cell, mark) is not None for cell in filled)
    stamps = sum(number(cell, mark) is None and is_stamp(cell) for cell in filled)
    return numbers - (len(filled) - numbers - stamps) if numbers else 0
