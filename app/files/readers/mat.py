"""MATLAB files of level 5 (up to -v7) and 7.3."""

import numpy as np

from app.files import mat_writer
from app.files.contents import FileError, Table
from app.files.matlab import level5, level73
from app.files.matlab.tables import tables_of
from app.files.reader import Reader

SIGNATURE = b"\x89HDF\r\n\x1a\n"


class MatlabFile(Reader):
    """Variables, structures, cells, recordings of dSPACE and Simulink, iddata, idfrd and frd saved as structures."""

    kind = "mat"
    title = "MATLAB file"
    endings = ("mat",)

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        is_hdf5 = content[:8] == SIGNATURE or content[512:520] == SIGNATURE
        tables = tables_of(level73.tree(content) if is_hdf5 else level5.tree(content))
        if not tables:
            raise FileError(
                "the mat file has no arrays of numbers that are read; objects such as idfrd or timeseries are saved as"
                " structures with s = struct(object); save('file', '-struct', 's')"
            )
        return tables

    @classmethod
    def example(cls) -> bytes:
        k = np.arange(12.0)
        return mat_writer.write({"t": 0.1 * k, "u": np.sign(np.sin(k)), "y": np.cos(0.7 * k)})
