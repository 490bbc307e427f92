"""Parquet files: columns with their types."""

import io
from typing import Any

from app.files.arrow import ArrowTable, example
from app.files.contents import MAX_EXPANDED_BYTES, FileError


class ParquetFile(ArrowTable):
    """A Parquet file, as pandas, polars or Spark write it."""

    kind = "parquet"
    title = "Parquet file"
    endings = ("parquet", "pq")

    @classmethod
    def _arrow(cls, stream: io.BytesIO) -> Any:
        from pyarrow import parquet

        file = parquet.ParquetFile(stream)
        if (
            sum(file.metadata.row_group(i).total_byte_size for i in range(file.metadata.num_row_groups))
            > MAX_EXPANDED_BYTES
        ):
            raise FileError(f"the file would expand to more than {MAX_EXPANDED_BYTES} bytes")
        return file.read()

    @classmethod
    def example(cls) -> bytes:
        from pyarrow import parquet

        buffer = io.BytesIO()
        parquet.write_table(example(), buffer)
        return buffer.getvalue()
