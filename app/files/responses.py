"""Columns of a frequency response to frequencies, complex values and what is known of their noise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.files import channel_columns
from app.files.assignment import Part, having, only
from app.files.contents import FileError
from app.files.conversion import numbers, radians_per_second, real, response_factor
from app.files.polar import polar
from app.files.repeats import averaged
from app.files.statements import Said
from app.files.variances import Noise, noise_of, response_factor_squared
from identification.arrays import ComplexArray, FloatArray

Number = TypeVar("Number", np.float64, np.complex128)
MATRICES = ("response", "real", "imaginary", "variance")
Entries = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, eq=False)
class Measured:
    """Frequencies (F,) in rad/s, response (F,) or (F, n_y, n_u), and its noise."""

    frequencies: FloatArray
    response: ComplexArray
    noise: Noise


def measured(
    parts: Sequence[Part],
    entries: Entries,
    said: Said,
    channels: tuple[int, int],
    averages: int | None,
    notes: list[str],
) -> Measured:
    """The response in columns; `entries`: matrices (F, n_y, n_u) put together from columns such as re_y1_u1.

    Lines at which a value is missing are left out and said. Raises FileError with what is missing or to be asked.
    """
    if not entries:
        parts = _whole_lines(parts, notes)
    omega = _frequencies(parts)
    response = matrices(_response(parts, entries, said, notes), len(omega), channels, "response")
    if response.ndim == 1 and len(np.unique(omega)) < len(omega):
        return _of_repeats(parts, omega, response, notes)
    if response.ndim == 1 and not having(parts, "variance"):
        return Measured(omega, response, noise_of(parts, response, averages, said, notes))
    return Measured(omega, response, Noise(_variance(parts, entries, len(omega), channels, said)))


def _of_repeats(parts: Sequence[Part], omega: FloatArray, response: ComplexArray, notes: list[str]) -> Measured:
    if omega.shape != response.shape:
        raise FileError(f"there are {len(omega)} frequencies and {len(response)} values")
    labels = [part for part in having(parts, "repeat") if part.is_number]
    mean = averaged(omega, response, real(labels[0], "repeat") if labels else None)
    notes.append(
        f"The file has {mean.repeats} repeats of {len(mean.frequencies)} frequencies; their mean is taken, and its"
        " variance from their differences."
    )
    return Measured(mean.frequencies, mean.response, Noise(mean.variance, mean.degrees_of_freedom))


def _whole_lines(parts: Sequence[Part], notes: list[str]) -> list[Part]:
    """Without the lines at which a column that matters has no value."""
    used = [part for part in parts if part.roles and part.is_number and part.column.values.ndim == 1]
    needed = [part for part in used if set(part.roles) & {"frequency", "angular", "response", "real", "imaginary"}]
    needed += [part for part in used if set(part.roles) & {"magnitude", "phase"}]
    lengths = {len(part.column.values) for part in needed if part.column.values.size > 1}
    if len(lengths) != 1:
        return list(parts)
    length = lengths.pop()
    whole = np.all([np.isfinite(part.column.values) for part in needed if len(part.column.values) == length], axis=0)
    if whole.all() or whole.sum() < 2:
        return list(parts)
    first = int(np.flatnonzero(~whole)[0]) + 1
    notes.append(
        f"{int((~whole).sum())} lines without a value are left out, the first of them line {first} of the data."
    )
    return [
        replace(part, column=replace(part.column, values=part.column.values[whole]))
        if part.column.values.shape == (length,)
        else part
        for part in parts
    ]


def _frequencies(parts: Sequence[Part]) -> FloatArray:
    found = having(parts, "frequency", "angular")
    if not found:
        raise FileError("the file has no frequencies; name the column frequency with its unit, such as frequency (Hz)")
    with_unit = [part for part in found if part.unit or "angular" in part.roles] or found
    values = [np.atleast_1d(radians_per_second(part)).ravel() for part in with_unit]
    for other in values[1:]:
        if other.shape != values[0].shape or np.max(np.abs(other - values[0])) > 1e-3 * np.max(np.abs(values[0])):
            only(with_unit, "frequency")
    return values[0]


def _response(parts: Sequence[Part], entries: Entries, said: Said, notes: list[str]) -> NDArray[np.complex128]:
    if "real" in entries or "imaginary" in entries:
        return _joined(entries.get("real"), entries.get("imaginary"))
    whole = [part for part in having(parts, "response") if part.is_complex or part.stated]
    phase, real_part, imaginary = (having(parts, role) for role in ("phase", "real", "imaginary"))
    if whole and not (phase and not whole[0].is_complex):
        return _complex(whole, said, notes)
    if real_part and imaginary:
        one, other = only(real_part, "responseRe"), only(imaginary, "responseIm")
        assert one is not None, "there are some"
        assert other is not None, "there are some"
        factors = [response_factor(part, said, notes) for part in (one, other)]
        return _joined(real(one, "real part") * factors[0], real(other, "imaginary part") * factors[1])
    magnitude = having(parts, "magnitude")
    if phase and magnitude:
        chosen, angle = _one_magnitude(magnitude), only(phase, "phase")
        assert angle is not None, "there are some"
        return polar(chosen, angle, said, notes)
    raise FileError(_missing(parts))


def _complex(whole: Sequence[Part], said: Said, notes: list[str]) -> NDArray[np.complex128]:
    part = only(whole, "response")
    assert part is not None, "there are some"
    values = np.atleast_1d(numbers(part))
    if not part.is_complex and np.all(values >= 0):
        raise FileError(
            f"the response {part.column.name[:40]!r} has real values only, none of them negative: it seems to be a"
            " magnitude, and a model needs the phase as well",
            "/columns",
        )
    return part.sign * response_factor(part, said, notes) * values.astype(np.complex128)


def _one_magnitude(magnitude: Sequence[Part]) -> Part:
    with_unit = [part for part in magnitude if part.unit]
    return with_unit[0] if with_unit else magnitude[0]


def _missing(parts: Sequence[Part]) -> str:
    if having(parts, "real") and not having(parts, "imaginary"):
        return "the file has real parts but no imaginary ones; name them responseIm, or say in columns which they are"
    if having(parts, "imaginary"):
        return "the file has imaginary parts but no real ones; name them responseRe, or say in columns which they are"
    if having(parts, "magnitude", "response"):
        return "the file has magnitudes but no phase, without which no model can be fitted; add the phase"
    return "the file has frequencies but no response; name it response, or responseRe and responseIm"


def _joined(real_part: NDArray[Any] | None, imaginary: NDArray[Any] | None) -> NDArray[np.complex128]:
    if real_part is None or imaginary is None:
        raise FileError(f"the file has no {'real' if real_part is None else 'imaginary'} parts of the response")
    if real_part.shape != imaginary.shape:
        raise FileError(f"the real parts have shape {real_part.shape}, the imaginary ones {imaginary.shape}")
    return np.asarray(np.atleast_1d(real_part + 1j * imaginary))


def _variance(
    parts: Sequence[Part], entries: Entries, count: int, channels: tuple[int, int], said: Said
) -> FloatArray | None:
    if "variance" in entries:
        return matrices(np.asarray(entries["variance"], dtype=np.float64), count, channels, "variance")
    part = only(having(parts, "variance"), "variance")
    if part is None:
        return None
    values = np.atleast_1d(real(part, "variance")) * response_factor_squared(part, said)
    return matrices(values, count, channels, "variance")


def matrices(values: NDArray[Number], count: int, channels: tuple[int, int], what: str) -> NDArray[Number]:
    """One number or one matrix (n_y, n_u) for each of `count` frequencies.

    Where the plant has one input or one output, the values may come as a table with a row a frequency; matrices may
    come with the frequencies last, as control toolboxes keep them. Raises FileError for other shapes.
    """
    if values.ndim > 1 and values.size == max(values.shape) and channels == (1, 1):
        return values.ravel()
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


def entries_of(named: Mapping[str, tuple[str, channel_columns.Entry, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Matrices from columns by meaning and entry; raises FileError where one is missing or double."""
    gathered: dict[str, channel_columns.Entries] = {}
    for name, (meaning, entry, values) in named.items():
        columns = gathered.setdefault(meaning, {})
        if entry in columns:
            raise FileError(f"two columns or arrays of the file mean the same, one of them is {name[:40]!r}")
        columns[entry] = values.ravel().astype(np.float64)
    result = {}
    for meaning, columns in gathered.items():
        try:
            result[meaning] = channel_columns.assembled(columns)
        except ValueError as error:
            raise FileError(f"the columns of the {meaning}: {error}") from None
    return result
