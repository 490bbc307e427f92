"""Texts that programs of instruments export: what they share as readers."""

from dataclasses import replace
from typing import ClassVar

from app.files.contents import Table
from app.files.reader import Reader
from app.files.text.decoding import decoded, head_text
from app.files.text.tables import tables_of


class TextExport(Reader):
    """A text that is told from others by a phrase near its beginning, in lower case; read like any text."""

    specific = True
    phrases: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def recognises(cls, head: bytes) -> bool:
        text = head_text(head).lower()
        return any(phrase in text for phrase in cls.phrases)

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        return [cls.known(table) for table in tables_of(decoded(content))]

    @classmethod
    def known(cls, table: Table) -> Table:
        """The table with what this program's columns are known to be, where their names do not say it."""
        return table


def renamed(table: Table, names: dict[str, tuple[str, str]]) -> Table:
    """The table with other names and units of columns, by their names without blanks."""
    columns = []
    for column in table.columns:
        name, unit = names.get(column.name.replace(" ", ""), (column.name, column.unit))
        columns.append(replace(column, name=name, unit=unit))
    return replace(table, columns=tuple(columns))


def spectrum() -> list[tuple[float, float, float, float]]:
    """Frequency in Hz, real part, minus imaginary part and magnitude in ohm of an example, line by line."""
    values = [(1000.0 / 4**k, 0.02 + 0.001 * k, 0.003 * k) for k in range(1, 9)]
    return [(f, real, minus, abs(complex(real, minus))) for f, real, minus in values]
