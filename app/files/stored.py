"""Kept arrays as files to download."""

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from app.files import csv_writer, mat_writer, npz_writer, wav_file
from app.files.channel_columns import taken_apart

Format = Literal["csv", "npz", "mat"]
SignalFormat = Literal["csv", "npz", "mat", "wav"]
MEDIA_TYPES = {
    "csv": "text/csv",
    "npz": "application/octet-stream",
    "mat": "application/octet-stream",
    "wav": "audio/wav",
    "html": "text/html",
    "c": "text/x-c",
}


def arrays_file(arrays: Mapping[str, NDArray[Any]], file_format: Format) -> bytes:
    """Arrays of one length as a file; in csv complex ones and matrices are split, and numbers beside them repeated."""
    if file_format == "npz":
        return npz_writer.write(dict(arrays))
    if file_format == "mat":
        return mat_writer.write(arrays)
    columns: dict[str, NDArray[Any]] = {}
    length = max(len(np.atleast_1d(array)) for array in arrays.values())
    for name, array in arrays.items():
        if array.ndim > 1:
            columns |= _of_matrices(array)
            continue
        full = np.broadcast_to(array, length)
        if np.iscomplexobj(full):
            columns |= {f"{name}Re": full.real, f"{name}Im": full.imag}
        else:
            columns[name] = full
    return csv_writer.write(columns)


def _of_matrices(array: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Columns of a response or its variance, (F, n_y, n_u)."""
    if np.iscomplexobj(array):
        return taken_apart("re", array.real) | taken_apart("im", array.imag)
    return taken_apart("var", array)


def wav(signal: NDArray[np.float64], sample_time: float) -> bytes:
    """A signal as WAV; see `app.files.wav_file`."""
    return wav_file.write(signal, sample_time)
