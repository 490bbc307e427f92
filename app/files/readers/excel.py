"""Excel workbooks: every sheet a table, its header found like that of a text."""

import io
from typing import Any

import numpy as np

from app.files.contents import MAX_COLUMNS, FileError, Table
from app.files.reader import Reader
from app.files.text.tables import tables_of

MAX_ROWS = 1_100_000
DAMAGE = (KeyError, ValueError, TypeError, OSError, EOFError, AttributeError, RuntimeError, NotImplementedError)


class ExcelWorkbook(Reader):
    """Sheets of an .xlsx or .xlsm file with the values of their cells; formulas count by what Excel computed."""

    kind = "excel"
    title = "Excel workbook"
    endings = ("xlsx", "xlsm")

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        import zipfile

        from openpyxl import load_workbook

        try:
            book = load_workbook(io.BytesIO(content), read_only=True, data_only=True)
            texts = {sheet.title: _text(sheet) for sheet in book.worksheets}
        except (zipfile.BadZipFile, *DAMAGE) as error:
            raise FileError(f"the file is not a whole Excel workbook: {str(error)[:200]}; save it as .xlsx") from None
        made = [_named(title, table) for title, text in texts.items() for table in _tables(text)]
        if not made:
            raise FileError("no sheet of the workbook has a table of numbers")
        return made if len(made) > 1 else [Table(made[0].columns, "", made[0].facts)]

    @classmethod
    def example(cls) -> bytes:
        from openpyxl import Workbook

        book = Workbook()
        sheet = book.active
        sheet.title = "Messung"
        sheet.append(["Operator", "N.N."])
        sheet.append([])
        sheet.append(["Zeit [ms]", "u [V]", "y [mm]"])
        for k in range(8):
            sheet.append([5.0 * k, float(k % 3 - 1), 0.25 * k])
        buffer = io.BytesIO()
        book.save(buffer)
        return buffer.getvalue()


def _text(sheet: Any) -> str:
    """The sheet as a text with bars between its cells, so that one way finds headers, units and gaps."""
    if (sheet.max_column or 0) > 10 * MAX_COLUMNS or (sheet.max_row or 0) > MAX_ROWS:
        raise FileError(f"the sheet {sheet.title[:40]!r} is too large; keep its table in a file of its own")
    rows = [["" if cell is None else _cell(cell) for cell in row] for row in sheet.iter_rows(values_only=True)]
    width = max((len(row) - next((i for i, c in enumerate(reversed(row)) if c), len(row)) for row in rows), default=0)
    used = [j for j in range(width) if any(len(row) > j and row[j] for row in rows)]
    return "\n".join("|".join(row[j] if j < len(row) else "" for j in used) for row in rows)


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, int | float):
        return repr(float(value)) if np.isfinite(value) else "nan"
    text = value.isoformat(sep=" ") if hasattr(value, "hour") and hasattr(value, "year") else str(value)
    return text.replace("|", "/" if text.count("|") == 1 else "").replace("\n", " ")


def _tables(text: str) -> list[Table]:
    try:
        return tables_of(text)
    except FileError:
        if any(character.isdigit() for character in text) and text.count("\n") > 1 and "|" in text:
            raise
        return []


def _named(title: str, table: Table) -> Table:
    return Table(table.columns, f"{title} {table.name}".strip(), table.facts)
