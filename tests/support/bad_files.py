"""Files made to do harm, or broken on the way."""

import io
import pickle
import struct
import zipfile

import numpy as np

from app.files import mat_writer, npz_writer

GIBIBYTE = 1024**3


def good_arrays(count: int = 50) -> dict[str, np.ndarray]:
    generator = np.random.default_rng(0)
    return {
        "time": np.arange(count) * 1.0,
        "input": generator.normal(size=count),
        "output": generator.normal(size=count),
    }


def npy_header(shape: str, descr: str = "'<f8'") -> bytes:
    text = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}"
    text += " " * (63 - (10 + len(text)) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


def zipped(members: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def zip_bomb() -> bytes:
    """Half a megabyte that would expand to half a gigabyte and more."""
    buffer = io.BytesIO()
    block = bytes(16 * 1024 * 1024)
    with (
        zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("input.npy", "w", force_zip64=True) as member,
    ):
        member.write(npy_header("(80000000,)"))
        for _ in range(38):
            member.write(block)
    return buffer.getvalue()


def lying_zip() -> bytes:
    """A member that says it is short and is long."""
    content = zipped({"input.npy": npy_header("(8000000,)") + bytes(64_000_000)})
    directory = content.rindex(b"PK\x01\x02")
    return content[: directory + 24] + struct.pack("<I", 1000) + content[directory + 28 :]


class _Exploit:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return exec, ("raise SystemExit('unpickled')",)


def pickled_npz() -> bytes:
    return zipped({"input.npy": npy_header("(1,)", "'|O'") + pickle.dumps([_Exploit()])})


def mat_with_type(code: int) -> bytes:
    """A file whose first numbers are of a type that does not exist; some readers follow it out of their tables."""
    content = bytearray(mat_writer.write({"input": np.arange(5.0), "output": np.arange(5.0)}))
    position = content.index(struct.pack("<II", mat_writer.DOUBLE, 40))
    content[position : position + 4] = struct.pack("<I", code)
    return bytes(content)


def mat_bomb() -> bytes:
    """A compressed element that would expand to more than half a gigabyte."""
    import zlib

    packer = zlib.compressobj(9)
    block = bytes(16 * 1024 * 1024)
    packed = b"".join(packer.compress(block) for _ in range(34)) + packer.flush()
    return mat_writer.HEADER + struct.pack("<II", 15, len(packed)) + packed


def mat_with_shape(rows: int) -> bytes:
    content = bytearray(mat_writer.write({"input": np.arange(5.0)}))
    position = content.index(struct.pack("<ii", 5, 1))
    content[position : position + 4] = struct.pack("<i", rows)
    return bytes(content)


_NPZ = npz_writer.write(good_arrays())
_MAT = mat_writer.write(good_arrays())

BAD_FILES: dict[str, tuple[str, bytes]] = {
    "empty csv": ("a.csv", b" "),
    "csv of words": ("a.csv", b"input,output\none,two\n"),
    "csv with ragged lines": ("a.csv", b"time,input,output\n0,1,2\n1,2\n"),
    "csv without names": ("a.csv", b"1,2,3\n1,2,3\n"),
    "csv with not-a-number": ("a.csv", b"time,input,output\n0,1,2\n1,nan,3\n"),
    "csv with an infinity": ("a.csv", b"time,input,output\n0,1,2\n1,inf,3\n"),
    "csv of a picture": ("a.csv", b"\x89PNG\r\n\x1a\n\x00\x01time,input,output\n0,1,2\n1,2,3\n"),
    "csv of zero bytes": ("a.csv", bytes(100)),
    "csv of one sample": ("a.csv", b"time,input,output\n0,1,2\n"),
    "csv of zeros": ("a.csv", b"time,input,output\n" + b"".join(b"%d,0,0\n" % i for i in range(60))),
    "csv with mixed sample times": ("a.csv", b"time,input,output\n0,1,2\n1,2,1\n2,1,0\n5,2,2\n6,1,1\n"),
    "csv with time running back": ("a.csv", b"time,input,output\n3,1,2\n2,2,1\n1,1,0\n"),
    "npz that is none": ("a.npz", b"no zip at all"),
    "truncated npz": ("a.npz", _NPZ[: len(_NPZ) // 2]),
    "npz with flipped bytes": ("a.npz", _NPZ[:80] + bytes(40) + _NPZ[120:]),
    "zip bomb": ("a.npz", zip_bomb()),
    "zip with wrong sizes": ("a.npz", lying_zip()),
    "pickle": ("a.npz", pickled_npz()),
    "npz with a path": ("a.npz", zipped({"../../etc/input.npy": npy_header("(1,)") + bytes(8)})),
    "npz of a huge shape": ("a.npz", zipped({"input.npy": npy_header("(1000000000000,)") + bytes(8)})),
    "npz of a negative shape": ("a.npz", zipped({"input.npy": npy_header("(-1,)") + bytes(8)})),
    "npz with code in its header": ("a.npz", zipped({"input.npy": npy_header("__import__('os').getpid()")})),
    "npz of words": ("a.npz", npz_writer.write({"input": np.array(["a", "b"]), "output": np.array(["c", "d"])})),
    "npz of different lengths": (
        "a.npz",
        npz_writer.write({"u": np.ones(5), "y": np.ones(6), "ts": np.ones(1)}),
    ),
    "npz of matrices": ("a.npz", npz_writer.write({"input": np.ones((5, 2)), "output": np.ones((5, 2))})),
    "npz without arrays": ("a.npz", zipped({})),
    "mat that is none": ("a.mat", b"MATLAB" * 100),
    "mat of version 7.3": ("a.mat", b"\x89HDF\r\n\x1a\n" + bytes(600)),
    "truncated mat": ("a.mat", _MAT[:300]),
    "mat of zeros": ("a.mat", _MAT[:128] + bytes(5000)),
    "mat with a type that crashes readers": ("a.mat", mat_with_type(8)),
    "mat with a type beyond the table": ("a.mat", mat_with_type(0x1234)),
    "mat bomb": ("a.mat", mat_bomb()),
    "mat of a huge shape": ("a.mat", mat_with_shape(2**31 - 1)),
    "mat of a negative shape": ("a.mat", mat_with_shape(-5)),
}
