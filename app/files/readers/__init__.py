"""Readers of files, one kind a module; they are found, not listed."""

import sys
from collections.abc import Mapping
from functools import cache

from app.files.contents import FileError, Table
from app.files.reader import Reader
from identification.registry import discover

HEAD = 8192


@cache
def readers() -> Mapping[str, type[Reader]]:
    """The readers by their kinds."""
    return discover(sys.modules[__name__])


def endings() -> list[str]:
    """All endings of names that are read, in order."""
    return sorted({ending for reader in readers().values() for ending in reader.endings})


def kind_of_file(name: str, content: bytes) -> str | None:
    """The kind of the reader for a file by the end of its name and its first bytes; None when there is none.

    Of several readers for an ending, those that know the file by what it says go first.
    """
    fitting = [one for one in readers().values() if name.lower().endswith(tuple(f".{end}" for end in one.endings))]
    fitting.sort(key=lambda one: not one.specific)
    head = content[:HEAD]
    found = next((one for one in fitting if one.recognises(head)), fitting[0] if fitting else None)
    return None if found is None else found.kind


def read_tables(content: bytes, kind: str) -> list[Table]:
    """The tables in a file of a kind; raises FileError."""
    if kind not in readers():
        raise FileError(f"files of the kind {kind!r} are not read; kinds are {', '.join(readers())}")
    tables = readers()[kind].read(content)
    if not any(table.columns for table in tables):
        raise FileError("the file has no columns or arrays of numbers")
    return tables
