"""npz: a zip of npy arrays. Nothing is unpacked before its stated size is known, and nothing is unpickled."""

import io
import math
import zipfile
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files import npz_writer
from app.files.contents import MAX_EXPANDED_BYTES, MAX_MEMBERS, FileError, Table, from_arrays
from app.files.reader import Reader

MAX_HEADER_BYTES = 10_000


class NumpyArchive(Reader):
    """Arrays that numpy.savez saved."""

    kind = "npz"
    title = "numpy archive"
    endings = ("npz",)

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        try:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                members = archive.infolist()
                _check(members)
                return [from_arrays({one.filename.removesuffix(".npy"): _array(archive, one) for one in members})]
        except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError) as error:
            raise FileError(f"the file is not a whole npz file: {str(error)[:200]}") from None
        except FileError:
            raise
        except (ValueError, TypeError, SyntaxError, OverflowError, MemoryError, zipfile.LargeZipFile) as error:
            raise FileError(f"the npz file cannot be read: {str(error)[:200]}") from None

    @classmethod
    def example(cls) -> bytes:
        k = np.arange(12.0)
        return npz_writer.write({"time": 0.1 * k, "input": np.sign(np.sin(k)), "output": np.cos(0.7 * k)})


def _check(members: list[zipfile.ZipInfo]) -> None:
    if len(members) > MAX_MEMBERS:
        raise FileError(f"the npz file has {len(members)} members, at most {MAX_MEMBERS} are read")
    for info in members:
        name = info.filename
        if not name.endswith(".npy") or "/" in name or "\\" in name or len(name) > 200 or not name.isprintable():
            raise FileError("the npz file has a member that is no array; save it with numpy.savez")
    if len({info.filename for info in members}) < len(members):
        raise FileError("two arrays of the npz file have the same name")
    size = sum(info.file_size for info in members)
    if size > MAX_EXPANDED_BYTES:
        raise FileError(f"the npz file would expand to {size} bytes, at most {MAX_EXPANDED_BYTES} are read")


def _array(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> NDArray[Any]:
    with archive.open(info) as member:
        data = member.read(info.file_size + 1)
    if len(data) != info.file_size:
        raise FileError("the npz file states wrong sizes of its members")
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    if version not in ((1, 0), (2, 0)):
        raise FileError("the npz file has an array of an unknown version")
    reader = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = reader(stream, max_header_size=MAX_HEADER_BYTES)
    if dtype.hasobject:
        raise FileError("the npz file holds Python objects; save plain arrays of numbers")
    if math.prod(shape) * dtype.itemsize != len(data) - stream.tell():
        raise FileError("the npz file has an array whose size is not what its header says")
    stream.seek(0)
    array: NDArray[Any] = np.lib.format.read_array(stream, allow_pickle=False)
    return array
