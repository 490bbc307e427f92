"""TDMS files of LabVIEW: groups of channels with their waveform properties."""

import io
from typing import Any

import numpy as np

from app.files.contents import MAX_EXPANDED_BYTES, Column, FileError, Table, counted
from app.files.extras import needed
from app.files.reader import Reader


class TdmsFile(Reader):
    """Each group a table; the sample time is the wf_increment of its channels."""

    kind = "tdms"
    title = "TDMS file"
    endings = ("tdms",)

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        nptdms = needed("nptdms", "tdms")
        try:
            with nptdms.TdmsFile.open(io.BytesIO(content)) as file:
                groups = file.groups()
                size = sum(len(channel) * 8 for group in groups for channel in group.channels())
                if size > MAX_EXPANDED_BYTES:
                    raise FileError(f"the TDMS file would expand to more than {MAX_EXPANDED_BYTES} bytes")
                tables = [table for group in groups if (table := _table(group)).columns]
        except FileError:
            raise
        except Exception as error:  # the library raises errors of many kinds for damaged files
            raise FileError(f"the file is not a whole TDMS file: {str(error)[:200]}") from None
        if not tables:
            raise FileError("the TDMS file has no channels of numbers")
        return tables if len(tables) > 1 else [Table(tables[0].columns, "", tables[0].facts)]

    @classmethod
    def example(cls) -> bytes:
        nptdms = needed("nptdms", "tdms")
        k = np.arange(8.0)
        channels = [
            nptdms.ChannelObject("run 1", name, values, properties={"wf_increment": 0.005, "unit_string": unit})
            for name, unit, values in (("u", "V", k % 3 - 1), ("y", "mm", 0.25 * k))
        ]
        buffer = io.BytesIO()
        with nptdms.TdmsWriter(buffer) as writer:
            writer.write_segment(channels)
        return buffer.getvalue()


def _table(group: Any) -> Table:
    channels = [channel for channel in group.channels() if channel.dtype is not None and len(channel) > 0]
    counted(len(channels), f"the group {group.name[:40]!r}")
    columns = []
    steps = set()
    for channel in channels:
        values = np.asarray(channel[:])
        if values.dtype.kind == "M":
            values = (values - values[0]) / np.timedelta64(1, "s")
        if values.dtype.kind not in "biufc":
            continue
        unit = str(channel.properties.get("unit_string") or channel.properties.get("NI_UnitDescription") or "")
        columns.append(Column(channel.name, values, unit))
        step = channel.properties.get("wf_increment")
        steps |= {float(step)} if step else set()
    if len(steps) > 1:
        raise FileError(f"the channels of {group.name[:40]!r} have different sample times; resample them to one")
    facts = {"sampleTimeSeconds": steps.pop()} if steps else {}
    return Table(tuple(columns), group.name, facts)
