"""What a file is read into: named arrays under one set of names."""

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files import channel_columns
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
# What may have one matrix a frequency.
MATRICES = ("response", "real", "imaginary", "variance")
_MEANING = {name: meaning for meaning, names in NAMES.items() for name in names}

Table = dict[str, NDArray[Any]]
Understand = Callable[[Mapping[str, NDArray[Any]]], Table]


class FileError(MisuseError):
    """The file cannot be read as a measurement; the message says what to change."""

    def __init__(self, message: str) -> None:
        super().__init__(message, "/file")


def may_be_read(name: str, array: NDArray[Any]) -> bool:
    """Whether an array is a vector, or the matrices or table of something that may have several channels."""
    several = meaning_of(name) in MATRICES and array.ndim <= 3
    return several or array.size == max(array.shape)


def meaning_of(name: str) -> str | None:
    """What a column or array of this name means; None when it is not understood."""
    return _MEANING.get(plain(name))


def plain(name: str) -> str:
    """A name without case, spaces, dashes and underscores."""
    return re.sub(r"[\s_\-()/]", "", name).lower()


def named(members: Mapping[str, NDArray[Any]]) -> Table:
    """The arrays by their meaning; raises FileError when two names mean the same or none is understood."""
    table: Table = {}
    entries: dict[str, channel_columns.Entries] = {}
    for name, array in members.items():
        short = plain(name)
        entry = channel_columns.entry_of(short)
        meaning = entry[0] if entry else _MEANING.get(short)
        if meaning is None:
            continue
        if meaning in table or (entry and entry[1] in entries.get(meaning, {})):
            raise FileError(f"two columns or arrays of the file mean the same, one of them is {name[:40]!r}")
        if entry:
            entries.setdefault(meaning, {})[entry[1]] = _numbers(name, array, entry[0]).ravel()
        else:
            table[meaning] = _numbers(name, array, meaning)
    _add(table, entries)
    if not table:
        raise FileError(
            "no column or array of the file has a name that is understood; name them time, input, output, or"
            " frequenciesRadPerSecond (frequencyHz), responseRe, responseIm, variance; with"
            " several inputs or outputs re_y1_u1, im_y1_u1, var_y1_u1, …"
        )
    return table


def _add(table: Table, entries: Mapping[str, channel_columns.Entries]) -> None:
    """Put matrices in the place of their columns."""
    for meaning, columns in entries.items():
        if meaning in table:
            raise FileError(f"the file has the {meaning} both as one array and by columns of outputs and inputs")
        try:
            table[meaning] = channel_columns.assembled(columns)
        except ValueError as error:
            raise FileError(f"the columns of the {meaning}: {error}") from None


def numbers(name: str, array: NDArray[Any]) -> NDArray[Any]:
    """The array itself; raises FileError when it holds anything but numbers."""
    if array.dtype.kind not in "iufcb":
        raise FileError(f"{name[:40]!r} holds no numbers")
    return array


def _numbers(name: str, array: NDArray[Any], meaning: str) -> NDArray[Any]:
    array = numbers(name, array)
    most = 3 if meaning in MATRICES else 1
    plain = array if array.ndim == most > 1 else np.squeeze(array)
    if plain.ndim > most:
        raise FileError(f"{name[:40]!r} has shape {array.shape}; give one value a sample")
    return plain.astype(np.complex128 if array.dtype.kind == "c" else np.float64)
