"""Columns and arrays whose names do not say what they are: what is said of them, such as input=force."""

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from app.files import table
from identification.errors import MisuseError

CHOICES = (
    "time",
    "input",
    "output",
    "frequenciesRadPerSecond",
    "frequencyHz",
    "response",
    "responseRe",
    "responseIm",
    "variance",
)

Members = Mapping[str, NDArray[Any]]


def renamed(members: Members, stated: Sequence[str]) -> Members:
    """The arrays under names that are understood; other arrays of the same meaning are left out.

    Raises MisuseError when something is named twice or not there.
    """
    pairs = [one.partition("=")[::2] for one in stated]
    meanings = {name: meaning for meaning, name in pairs}
    if len(meanings) < len(pairs) or len({meaning for meaning, _ in pairs}) < len(pairs):
        raise MisuseError("each column and each meaning may be named once", "/columns")
    absent = [name for name in meanings if name not in members]
    if absent:
        known = ", ".join(name[:40] for name in members)[:500]
        raise MisuseError(f"the file has no column or array {absent[0][:40]!r}; it has {known}", "/columns")
    taken = {table.meaning_of(meaning) for meaning in meanings.values()}
    others = {name: array for name, array in members.items() if name not in meanings}
    kept = {name: array for name, array in others.items() if table.meaning_of(name) not in taken}
    return {**kept, **{meaning: members[name] for name, meaning in meanings.items()}}
