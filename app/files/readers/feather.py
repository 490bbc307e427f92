"""Feather (Arrow IPC) files: columns with their types."""

import io
from typing import Any

from app.files.arrow import ArrowTable, example


class FeatherFile(ArrowTable):
    """A Feather (Arrow IPC) file."""

    kind = "feather"
    title = "Feather file"
    endings = ("feather", "arrow", "ipc")

    @classmethod
    def _arrow(cls, stream: io.BytesIO) -> Any:
        from pyarrow import feather

        return feather.read_table(stream, memory_map=False)

    @classmethod
    def example(cls) -> bytes:
        from pyarrow import feather

        buffer = io.BytesIO()
        feather.write_feather(example(), buffer)
        return buffer.getvalue()
