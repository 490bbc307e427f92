"""What a file is read into: named arrays under one set of names."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from identification.errors import MisuseError

MAX_EXPANDED_BYTES = 512 * 1024 * 1024
MAX_MEMBERS = 100

# Names that are understood, without case, spaces, dashes and underscores.
NAMES = {
    "time": ("time", "t", "timeseconds", "times"),
    "input": ("input", "u", "inputs"),
    "output": ("output", "y", "outputs"),
    "frequencies": ("frequenciesradpersecond", "frequencyradpersecond", "frequencies", "frequency", "omega", "w"),
    "hertz": ("frequencieshertz", "frequencyhertz", "frequencyhz", "freqhz", "frequencieshz", "frequenz", "hz"),
    "response": ("response", "g", "h", "z", "frequencyresponse", "frf"),
    "real": ("responsere", "real", "re", "zreal", "zre", "zreohm", "responsereal"),
    "imaginary": ("responseim", "imaginary", "imag", "im", "zimg", "zim", "zimohm", "responseimag"),
    "variance": ("variance", "noisevariance", "responsevariance"),
    "sample_time": ("sampletimeseconds", "sampletime", "ts", "dt"),
    "period": ("periodsamples", "period"),
    "degrees_of_freedom": ("variancedegreesoffreedom",),
}
_MEANING = {name: meaning for meaning, names in NAMES.items() for name in names}

Table = dict[str, NDArray[Any]]


class FileError(MisuseError):
    """The file cannot be read as a measurement; the message says what to change."""

    def __init__(self, message: str) -> None:
        super().__init__(message, "/file")


def named(members: Mapping[str, NDArray[Any]]) -> Table:
    """The arrays by their meaning; raises FileError when two names mean the same or none is understood."""
    table: Table = {}
    for name, array in members.items():
        meaning = _MEANING.get(re.sub(r"[\s_\-()/]", "", name).lower())
        if meaning is None:
            continue
        if meaning in table:
            raise FileError(f"two columns or arrays of the file mean the same, one of them is {name[:40]!r}")
        table[meaning] = _numbers(name, array)
    if not table:
        raise FileError(
            "no column or array of the file has a name that is understood; name them time, input, output, or"
            " frequenciesRadPerSecond (frequencyHz), responseRe, responseIm, variance"
        )
    return table


def _numbers(name: str, array: NDArray[Any]) -> NDArray[Any]:
    if array.dtype.kind not in "iufcb":
        raise FileError(f"{name[:40]!r} holds no numbers")
    squeezed = np.squeeze(array)
    if squeezed.ndim > 1:
        raise FileError(f"{name[:40]!r} has shape {array.shape}; give one value a sample")
    return squeezed.astype(np.complex128 if array.dtype.kind == "c" else np.float64)
