"""Cells of tables: numbers with decimal points or commas, complex numbers, gaps, clock times."""

import re
from collections.abc import Sequence
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

GAPS = {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---", "nil", "#nv", "1.#qnan", "-1.#ind"}
INFINITE = {"inf": np.inf, "+inf": np.inf, "-inf": -np.inf, "infinity": np.inf, "-infinity": -np.inf, "1.#inf": np.inf}
_MINUS = str.maketrans("−–", "--", "\u00a0\u202f'")
_EXPONENT = r"(?:[eEdD][+-]?\d+)?"
_REAL = {
    ".": rf"(?:\d{{1,3}}(?:,\d{{3}})+\.\d*|\d+\.?\d*|\.\d+){_EXPONENT}",
    ",": rf"(?:\d{{1,3}}(?:\.\d{{3}})+,\d*|\d+,?\d*|,\d+){_EXPONENT}",
}
_NUMBER = {mark: re.compile(rf"[+-]?{real}") for mark, real in _REAL.items()}
_COMPLEX = {
    mark: re.compile(rf"([+-]?{real})?\s*(?:([+-])\s*({real})?\s*\*?\s*[ijIJ]|([+-])\s*[ijIJ]\s*\*?\s*({real}))")
    for mark, real in _REAL.items()
}
_IMAGINARY = {mark: re.compile(rf"([+-]?{real})\s*\*?\s*[ijIJ]") for mark, real in _REAL.items()}
_PAIR = re.compile(r"\(\s*([^\s,;]+)\s*[,;]\s*([^\s,;]+)\s*\)")
_CLOCK = re.compile(r"(\d{1,3}):(\d{2}):(\d{2}(?:[.,]\d+)?)")


def number(cell: str, mark: str) -> float | complex | None:
    """The number in a cell with this decimal mark, not-a-number for a gap; None when it is no number."""
    text = cell.strip().strip('"').translate(_MINUS).strip()
    if text.lower() in GAPS:
        return float("nan")
    if _NUMBER[mark].fullmatch(text):
        return _float(text, mark)
    return INFINITE.get(text.lower()) or _complex(text, mark)


def is_gap(cell: str) -> bool:
    """Whether a cell holds nothing."""
    return cell.strip().strip('"').lower() in GAPS


def _float(text: str, mark: str) -> float:
    other = "," if mark == "." else "."
    return float(text.replace(other, "").replace(mark, ".").replace("d", "e").replace("D", "e"))


def _complex(text: str, mark: str) -> complex | None:
    if (pair := _PAIR.fullmatch(text)) and mark == ".":
        ends = [number(one, mark) for one in pair.groups()]
        return None if None in ends else complex(*(float(np.real(one or 0.0)) for one in ends))
    text = text[1:-1].strip() if text.startswith("(") and text.endswith(")") else text
    if found := _IMAGINARY[mark].fullmatch(text):
        return complex(0.0, _float(found[1], mark))
    found = _COMPLEX[mark].fullmatch(text)
    if found is None:
        return None
    sign = -1.0 if "-" in (found[2], found[4]) else 1.0
    size = found[3] or found[5]
    real = 0.0 if found[1] is None else _float(found[1], mark)
    return complex(real, sign * (1.0 if size is None else _float(size, mark)))


def column(cells: Sequence[str], mark: str) -> NDArray[Any]:
    """The cells of a column as numbers, complex numbers, seconds of clock times, or else as texts."""
    values = [number(cell, mark) for cell in cells]
    if None not in values:
        kind = np.complex128 if any(isinstance(value, complex) for value in values) else np.float64
        return np.array(values, dtype=kind)
    stamps = [_seconds(cell.strip().strip('"')) for cell in cells]
    if None not in stamps:
        return np.array(stamps, dtype=np.float64)
    return np.array([cell.strip().strip('"')[:200] for cell in cells])


def is_stamp(cell: str) -> bool:
    """Whether a cell is a clock time or a date with a time."""
    return _seconds(cell.strip().strip('"')) is not None


def _seconds(text: str) -> float | None:
    """Seconds of a clock time such as 12:30:00.5, or of a date and time."""
    if found := _CLOCK.fullmatch(text):
        return 3600.0 * int(found[1]) + 60.0 * int(found[2]) + float(found[3].replace(",", "."))
    if not text[:4].isdigit() or len(text) < 16:
        return None
    try:
        moment = datetime.fromisoformat(text.replace("/", "-").replace(",", "."))
    except ValueError:
        return None
    return (moment.replace(tzinfo=None) - datetime(1970, 1, 1)).total_seconds()
