"""MDF files (ASAM, version 4 and 3) of measurement systems: groups of channels that share a time axis."""

import gc
import io
import sys

import numpy as np

from app.files.contents import MAX_EXPANDED_BYTES, Column, FileError, Table
from app.files.extras import needed
from app.files.reader import Reader


class MdfFile(Reader):
    """Each group of channels a table, with the time stamps of its master channel."""

    kind = "mdf"
    title = "MDF file"
    endings = ("mf4", "mdf")

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        asammdf = needed("asammdf", "mdf")
        tables: list[Table] = []
        failure = ""
        try:
            with asammdf.MDF(io.BytesIO(content)) as file:
                tables = [table for index in range(len(file.groups)) if (table := _group(file, index)) is not None]
        except FileError:
            raise
        except Exception as error:  # the library raises errors of many kinds for damaged files
            failure = f"the file is not a whole MDF file: {str(error)[:200]}"
        if failure:
            _cleared()
            raise FileError(failure)
        if not tables:
            raise FileError("the MDF file has no channels of numbers")
        return tables if len(tables) > 1 else [Table(tables[0].columns)]

    @classmethod
    def example(cls) -> bytes:
        asammdf = needed("asammdf", "mdf")
        k = np.arange(8.0)
        signals = [
            asammdf.Signal(samples=values, timestamps=0.005 * k, name=name, unit=unit)
            for name, unit, values in (("u", "V", k % 3 - 1), ("y", "mm", 0.25 * k))
        ]
        buffer = io.BytesIO()
        with asammdf.MDF(version="4.10") as file:
            file.append(signals)
            file.save(buffer)
        return buffer.getvalue()


def _cleared() -> None:
    """Clear away half-made objects of the library, whose finalizers fail, without a word about them."""
    hook, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        gc.collect()
    finally:
        sys.unraisablehook = hook


def _group(file: object, index: int) -> Table | None:
    group = file.groups[index]  # type: ignore[attr-defined]
    if group.channel_group.cycles_nr * (group.channel_group.samples_byte_nr or 8) > MAX_EXPANDED_BYTES:
        raise FileError(f"a group of the MDF file would expand to more than {MAX_EXPANDED_BYTES} bytes")
    master = file.get_master(index)  # type: ignore[attr-defined]
    columns = [Column("time", np.asarray(master, dtype=np.float64), "s")]
    for number, channel in enumerate(group.channels):
        if number == file.masters_db.get(index):  # type: ignore[attr-defined]
            continue
        signal = file.get(group=index, index=number)  # type: ignore[attr-defined]
        if signal.samples.dtype.kind in "biuf" and signal.samples.ndim == 1:
            columns.append(Column(channel.name, signal.samples, signal.unit or ""))
    return Table(tuple(columns), group.channel_group.acq_name or f"group {index + 1}") if len(columns) > 1 else None
