"""CSV: one header line with names, then one line a sample or frequency, separated by commas."""

import csv
import io
from collections.abc import Mapping

from identification.arrays import FloatArray


def write(columns: Mapping[str, FloatArray]) -> bytes:
    """A table with a header; numbers are written so that reading gives them back exactly."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(map(repr, column.tolist()) for column in columns.values()), strict=True))
    return text.getvalue().encode()
