"""CSV: one header line with names, then one line a sample or frequency. Comma, semicolon or tab."""

import csv
import io
from collections.abc import Mapping

import numpy as np

from app.files.table import FileError, Table, Understand, named
from identification.arrays import FloatArray

MAX_COLUMNS = 100


def read(content: bytes, understand: Understand = named) -> Table:
    """The columns of a file, as `understand` takes them; raises FileError when it is no table of numbers."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError("the file is not a text in UTF-8") from None
    if "\0" in text:
        raise FileError("the file is not a text")
    header, _, body = text.lstrip().partition("\n")
    separator = max(",;\t", key=header.count)
    names = [name.strip().strip('"') for name in header.split(separator)]
    if len(names) > MAX_COLUMNS:
        raise FileError(f"the file has {len(names)} columns, at most {MAX_COLUMNS} are read")
    values = _values(body, separator, len(names))
    if len(set(names)) < len(names):
        raise FileError("two columns of the file have the same name")
    return understand(dict(zip(names, values.T, strict=True)))


def _values(body: str, separator: str, columns: int) -> FloatArray:
    if not body.strip():
        raise FileError("the file has no lines below its header")
    try:
        values = np.loadtxt(io.StringIO(body), delimiter=separator, ndmin=2, comments=None, quotechar='"')
    except ValueError as error:
        raise FileError(f"the file is not a table of numbers: {str(error).splitlines()[0][:200]}") from None
    if values.shape[1] != columns:
        raise FileError(f"the header has {columns} names, the lines have {values.shape[1]} values")
    return values


def write(columns: Mapping[str, FloatArray]) -> bytes:
    """A table with a header; numbers are written so that reading gives them back exactly."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(map(repr, column.tolist()) for column in columns.values()), strict=True))
    return text.getvalue().encode()
