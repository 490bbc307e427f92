"""Touchstone files of network analysers: scattering, impedance or admittance parameters over frequency."""

import io
import math

import numpy as np

from app.files.contents import Column, FileError, Table
from app.files.extras import needed
from app.files.reader import Reader
from app.files.text.decoding import decoded


class TouchstoneFile(Reader):
    """s1p … s4p (and y, z): the parameters as they stand in the file, and their units of frequency."""

    kind = "touchstone"
    title = "Touchstone file"
    endings = ("s1p", "s2p", "s3p", "s4p", "z1p", "z2p", "y1p", "y2p", "ts")

    @classmethod
    def read(cls, content: bytes) -> list[Table]:
        skrf = needed("skrf", "touchstone")
        stream = io.StringIO(decoded(content))
        stream.name = f"file.s{_ports(content)}p"
        try:
            file = skrf.io.touchstone.Touchstone(stream)
            frequency, values = file.get_sparameter_arrays()
            kind = str(file.parameter or "s").upper()
        except (ValueError, TypeError, IndexError, KeyError, AttributeError, NotImplementedError) as error:
            raise FileError(f"the file is not a whole Touchstone file: {str(error)[:200]}") from None
        ports = values.shape[1]
        columns = [Column("frequency", np.asarray(frequency), "Hz")]
        if ports == 1:
            return [Table((*columns, Column("response", values[:, 0, 0])))]
        return [
            Table((*columns, Column("response", values[:, i, j])), f"{kind}{i + 1}{j + 1}")
            for i in range(ports)
            for j in range(ports)
        ] + [Table((*columns, Column("response", values)), f"{kind} matrix")]

    @classmethod
    def example(cls) -> bytes:
        rows = "\n".join(f"{k + 1} {0.5 / (k + 1):.6f} {-10.0 * k:.3f}" for k in range(8))
        return f"! made by an example\n# kHz S MA R 50\n{rows}\n".encode()


def _ports(content: bytes) -> int:
    """Ports from the numbers on the first line of data: 3, 9 in one line, or more in several lines a frequency."""
    lines = [line.split(b"!")[0].split() for line in content.splitlines()]
    data = [line for line in lines if line and not line[0].startswith((b"#", b"["))]
    if not data:
        raise FileError("the Touchstone file has no lines of numbers")
    first = len(data[0])
    if first in (3, 9):
        return 1 if first == 3 else 2
    block = first + sum(len(line) for line in _until_odd(data[1:]))
    return max(1, round(math.sqrt((block - 1) / 2)))


def _until_odd(lines: list[list[bytes]]) -> list[list[bytes]]:
    """The lines that go on with the first frequency: those with an even number of values."""
    end = next((i for i, line in enumerate(lines) if len(line) % 2), len(lines))
    return lines[:end]
