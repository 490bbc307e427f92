"""Arrow tables: what readers of Parquet and Feather files share."""

import io
from typing import Any

import numpy as np

from app.files.contents import MAX_EXPANDED_BYTES, Column, FileError, Table, counted
from app.files.reader import Reader


class ArrowTable(Reader):
    """What both formats share: an Arrow table."""

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        import pyarrow as pa

        try:
            table = cls._arrow(io.BytesIO(content))
        except (pa.ArrowException, OSError, ValueError, TypeError, KeyError, OverflowError) as error:
            raise FileError(f"the file is not a whole {cls.title}: {str(error)[:200]}") from None
        counted(table.num_columns, "the file")
        if table.nbytes > MAX_EXPANDED_BYTES:
            raise FileError(f"the file would expand to more than {MAX_EXPANDED_BYTES} bytes")
        fields = [(field, table.column(i)) for i, field in enumerate(table.schema)]
        columns = [
            Column(field.name, values, _unit(field)) for field, one in fields if (values := _values(one)) is not None
        ]
        if len({column.name for column in columns}) < len(columns):
            raise FileError("two columns of the file have the same name; give each its own")
        return [Table(tuple(columns))]

    @classmethod
    def _arrow(cls, stream: io.BytesIO) -> Any:
        raise NotImplementedError


def example() -> Any:
    import pyarrow as pa

    k = np.arange(8)
    return pa.table({"t (s)": 0.1 * k, "u": np.where(k % 3, 1.0, -1.0), "y": 0.5 * k})


def _unit(field: Any) -> str:
    metadata = field.metadata or {}
    return str(metadata.get(b"unit", b"").decode("utf-8", "replace"))


def _values(column: Any) -> Any:
    """The numbers of a column, times in seconds; None for what cannot be a measurement, such as lists."""
    import pyarrow as pa

    kind = column.type
    if pa.types.is_timestamp(kind) or pa.types.is_duration(kind):
        per_second = {"s": 1, "ms": 1e3, "us": 1e6, "ns": 1e9}[kind.unit]
        return column.cast(pa.int64()).to_numpy().astype(np.float64) / per_second
    if pa.types.is_string(kind) or pa.types.is_large_string(kind):
        return np.array([str(one)[:200] for one in column.to_pylist()])
    if pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind):
        return np.asarray(column.cast(pa.float64()).to_numpy())
    return None
