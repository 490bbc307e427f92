"""Universal file format 58: functions at degrees of freedom, as modal analysis systems write them."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from app.files.contents import Column, FileError, Table
from app.files.extras import needed
from app.files.reader import Reader

RESPONSES = {4: "response", 2: "auto spectrum", 3: "cross spectrum", 6: "coherence"}
TIME, FREQUENCY = 17, 18


class UniversalFile(Reader):
    """Data sets 58: frequency responses over Hz, and records over seconds; a set is a table."""

    kind = "uff"
    title = "universal file"
    endings = ("uff", "unv", "uf58", "bunv")

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        pyuff = needed("pyuff", "uff")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "file.uff"
            path.write_bytes(content)
            try:
                file = pyuff.UFF(str(path))
                kinds = file.get_set_types()
                sets = [file.read_sets(i) for i in range(len(kinds)) if kinds[i] == 58]
            except Exception as error:  # the library raises errors of many kinds for damaged files
                raise FileError(f"the file is not a whole universal file: {str(error)[:200]}") from None
        tables = _tables([one for one in sets if isinstance(one, dict)])
        if not tables:
            raise FileError("the universal file has no data set 58 with a response or a record")
        return tables if len(tables) > 1 else [Table(tables[0].columns)]

    @classmethod
    def example(cls) -> bytes:
        rows = "\n".join(
            "".join(f"{value:13.5e}" for pair in range(2) for value in ((k + pair) * 0.5, -0.25 * (k + pair)))
            for k in range(0, 8, 2)
        )
        records = ["an example", "NONE", "01-Jan-24 12:00:00", "NONE", "NONE"]
        head = "    4         0    0         0 NONE         1   3 NONE         1   3"
        axis = "         5         8         1  1.00000e+00  5.00000e-01  0.00000e+00"
        axes = [
            "        18    0    0    0 Frequency            Hz                  ",
            "         8    0    0    0 Acceleration         m/s2                ",
            "        13    0    0    0 Force                N                   ",
            "         0    0    0    0 NONE                 NONE                ",
        ]
        return "\n".join(["    -1", "    58", *records, head, axis, *axes, rows, "    -1", ""]).encode()


def _tables(sets: list[dict[str, Any]]) -> list[Table]:
    """Responses and coherences by their degrees of freedom; records that share a time axis as one table."""
    made: dict[str, list[Column]] = {}
    for one in sets:
        axis, values = np.asarray(one.get("x")), np.asarray(one.get("data"))
        if axis.ndim != 1 or axis.shape != values.shape or axis.size < 2:
            continue
        point = f"{one.get('rsp_node')}:{one.get('rsp_dir')}"
        if one.get("abscissa_spec_data_type") == TIME:
            columns = made.setdefault("records", [Column("time", axis, "s")])
            columns.append(Column(f"{point} {str(one.get('orddenom_axis_lab') or '').strip()}".strip(), values.real))
            continue
        what = RESPONSES.get(int(one.get("func_type", 0)))
        if what is None:
            continue
        name = f"{point} over {one.get('ref_node')}:{one.get('ref_dir')}"
        columns = made.setdefault(name, [Column("frequency", axis, "Hz")])
        columns.append(Column(what, values.real if what == "coherence" else values))
    return [Table(tuple(columns), name) for name, columns in made.items() if len(columns) > 1]
