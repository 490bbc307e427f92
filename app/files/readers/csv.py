"""Texts with a table: CSV and whatever instruments call so."""

from app.files.contents import Table
from app.files.reader import Reader
from app.files.text.decoding import decoded
from app.files.text.tables import tables_of


class TextTables(Reader):
    """Tables in a text, whatever separator, decimal mark, encoding and header; see `app.files.text`."""

    kind = "csv"
    title = "text with columns"
    endings = ("csv", "txt", "tsv", "dat", "asc", "prn", "data", "tab")

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        return tables_of(decoded(content))

    @classmethod
    def example(cls) -> bytes:
        rows = "\n".join(f"{k * 0.5:.1f};{(k * k) % 7 - 3},5;{(3 * k) % 5},25".replace(".", ",") for k in range(8))
        return f"Zeit [s];u [V];y [mm]\n{rows}\n".encode("latin-1")
