"""Tables to measurements: which columns there are decides what was measured."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from app.files import csv_file, mat_file, npz_file
from app.files.column_choice import Members, renamed
from app.files.table import FileError, Table, may_be_read, named
from identification.arrays import ComplexArray, FloatArray
from identification.signals import FrequencyResponse, Measurement, OperatingPoint, TimeRecord

Number = TypeVar("Number", np.float64, np.complex128)
SAMPLE_TIME_TOLERANCE = 1e-3
SHORTEST, LONGEST = 1e-15, 1e15  # sample times in seconds


@dataclass(frozen=True)
class Statements:
    """What is stated beside the file, which goes before what the file says.

    `channels`: the plant's outputs and inputs; `columns`: statements such as input=force.
    """

    operating_point: OperatingPoint
    sample_time: float | None = None
    period: int | None = None
    group: str = ""
    channels: tuple[int, int] = (1, 1)
    columns: tuple[str, ...] = ()


def read_measurement(content: bytes, file_format: str, stated: Statements) -> Measurement:
    """The measurement in a file of format csv, npz or mat; raises MisuseError."""

    def understand(members: Members) -> Table:
        return named(renamed(members, stated.columns))

    def understand_readable(members: Members) -> Table:
        chosen = renamed(members, stated.columns)
        return named({name: array for name, array in chosen.items() if may_be_read(name, array)})

    readers: dict[str, Callable[[], Table]] = {
        "csv": lambda: csv_file.read(content, understand),
        "npz": lambda: npz_file.read(content, understand),
        "mat": lambda: mat_file.read(content, stated.group, understand_readable),
    }
    return measurement(readers[file_format](), stated)


def measurement(table: Table, stated: Statements) -> Measurement:
    """A time record when there are input and output, a frequency response when there are frequencies."""
    for name, values in table.items():
        bad = np.flatnonzero(~np.isfinite(np.atleast_1d(values)))
        if bad.size:
            raise FileError(f"the {name} has a value at position {bad[0]} that is not a finite number")
    if "input" in table and "output" in table:
        return _time_record(table, stated)
    if "frequencies" in table or "hertz" in table:
        return _frequency_response(table, stated)
    raise FileError(
        f"the file has {', '.join(table)}; a time record needs input and output, a frequency response needs"
        " frequencies and response (or its real and imaginary parts)"
    )


def _time_record(table: Table, stated: Statements) -> TimeRecord:
    return TimeRecord(
        input=_real(table, "input"),
        output=_real(table, "output"),
        sample_time=record_sample_time(table, stated),
        operating_point=stated.operating_point,
        period=record_period(table, stated),
    )


def record_period(table: Table, stated: Statements) -> int | None:
    """The period in samples, as stated or as the file says."""
    return stated.period if stated.period is not None else _whole_number(table, "period")


def record_sample_time(table: Table, stated: Statements) -> float:
    """The sample time in seconds; raises FileError when there is none, or when file and statement differ."""
    found = _scalar(table, "sample_time")
    if "time" in table:
        found = _uniform_step(_real(table, "time"))
    if stated.sample_time is None:
        if found is None:
            raise FileError("the file has no time; state sampleTimeSeconds")
        if not SHORTEST <= found <= LONGEST:
            raise FileError(f"the sample time of the file, {found:g} s, is not between {SHORTEST} and {LONGEST} s")
        return found
    if found is not None and abs(found / stated.sample_time - 1) > SAMPLE_TIME_TOLERANCE:
        raise FileError(f"the file was sampled every {found:g} s, but sampleTimeSeconds is {stated.sample_time:g}")
    return stated.sample_time


def _uniform_step(time: FloatArray) -> float:
    steps = np.diff(time)
    if len(steps) == 0:
        raise FileError("a record needs at least two samples")
    step = (time[-1] - time[0]) / len(steps)
    if not step > 0 or np.max(np.abs(steps - step)) > 0.01 * step:
        raise FileError(
            f"the sample time changes between {steps.min():g} and {steps.max():g} s within the record; resample it"
        )
    return float(step)


def _frequency_response(table: Table, stated: Statements) -> FrequencyResponse:
    omega = _real(table, "frequencies") if "frequencies" in table else 2 * np.pi * _real(table, "hertz")
    found = _scalar(table, "sample_time")
    return FrequencyResponse(
        frequencies=omega,
        response=matrices(_response(table), len(omega), stated.channels, "response"),
        operating_point=stated.operating_point,
        sample_time=stated.sample_time if stated.sample_time is not None else found,
        variance=_variance(table, len(omega), stated.channels),
        variance_degrees_of_freedom=_scalar(table, "degrees_of_freedom"),
    )


def _response(table: Table) -> ComplexArray:
    if "response" in table:
        return np.atleast_1d(table["response"]).astype(np.complex128)
    if "real" in table and "imaginary" in table:
        real, imaginary = _real(table, "real"), _real(table, "imaginary")
        if real.shape != imaginary.shape:
            raise FileError(f"the real parts have shape {real.shape}, the imaginary ones {imaginary.shape}")
        return np.asarray(real + 1j * imaginary)
    raise FileError("the file has frequencies but no response; name it response, or responseRe and responseIm")


def matrices(values: NDArray[Number], count: int, channels: tuple[int, int], what: str) -> NDArray[Number]:
    """One number or one matrix (n_y, n_u) for each of `count` frequencies.

    Where the plant has one input or one output, the values may come as a table with a row a frequency; matrices may
    come with the frequencies last, as control toolboxes keep them. Raises FileError for other shapes.
    """
    if values.ndim == 1:
        return values
    if values.ndim == 2 and 1 in channels and values.shape == (count, channels[0] * channels[1]):
        return values.reshape(count, *channels)
    if values.ndim == 3 and len(values) == count:
        return values
    if values.ndim == 3 and values.shape[2] == count:
        return np.moveaxis(values, 2, 0)
    raise FileError(
        f"the {what} has shape {values.shape} for {count} frequencies; give one value a frequency, or one matrix with a"
        " row for each output and a column for each input"
    )


def _variance(table: Table, count: int, channels: tuple[int, int]) -> FloatArray | None:
    return matrices(_real(table, "variance"), count, channels, "variance") if "variance" in table else None


def _real(table: Table, name: str) -> FloatArray:
    values = np.atleast_1d(table[name])
    if np.iscomplexobj(values):
        raise FileError(f"the {name} is complex")
    return values.astype(np.float64)


def _scalar(table: Table, name: str) -> float | None:
    if name not in table:
        return None
    values = _real(table, name)
    if values.size == 0 or np.any(values != values[0]) or values[0] <= 0:
        raise FileError(f"the {name.replace('_', ' ')} in the file is not one positive number")
    return float(values[0])


def _whole_number(table: Table, name: str) -> int | None:
    value = _scalar(table, name)
    if value is not None and value != int(value):
        raise FileError(f"the {name} in the file is no whole number")
    return None if value is None else int(value)


def measurement_arrays(data: Measurement) -> Table:
    """The arrays that are kept of a measurement."""
    if isinstance(data, TimeRecord):
        return {"input": data.input, "output": data.output}
    arrays: Table = {"frequenciesRadPerSecond": data.frequencies, "response": data.response}
    return arrays if data.variance is None else {**arrays, "variance": data.variance}
