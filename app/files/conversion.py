"""Values of columns in the units that are kept: seconds, rad/s, and the units of the plant."""

import numpy as np
from numpy.typing import NDArray

from app.files import units
from app.files.assignment import Part
from app.files.contents import FileError
from app.files.statements import Said, Signal
from identification.arrays import ComplexArray, FloatArray

RECIPROCAL_SECONDS = ("1/s", "s^-1", "s⁻¹", "s-1", "1/sec")


def real(part: Part, what: str) -> FloatArray:
    """The values of a column with its sign, finite real numbers; raises FileError for others."""
    values = numbers(part)
    if np.iscomplexobj(values):
        raise FileError(f"the {what} is complex")
    return np.asarray(part.sign * values.astype(np.float64))


def numbers(part: Part) -> NDArray[np.float64] | ComplexArray:
    """The values of a column; raises FileError for texts and for what is not finite."""
    values = part.column.values
    if values.dtype.kind not in "biufc":
        raise FileError(f"{part.column.name[:40]!r} holds no numbers")
    values = values.astype(np.complex128 if values.dtype.kind == "c" else np.float64)
    bad = np.argwhere(~np.isfinite(np.atleast_1d(values)))
    if bad.size:
        raise FileError(
            f"{part.column.name[:40]!r} has a value at position {bad[0][0]} that is not a finite number; fill it in or"
            " leave the column or the line out"
        )
    return values


def seconds(part: Part, values: FloatArray) -> FloatArray:
    """Values in the unit of a column (seconds where none is said) in seconds."""
    found = units.conversion(part.unit, "s") if part.unit else (1.0, 0.0)
    if found is None:
        raise FileError(f"the time {part.column.name[:40]!r} is in {part.unit!r}, which is no time", "/units")
    return values * found[0]


def radians_per_second(part: Part) -> FloatArray:
    """Frequencies in rad/s; raises FileError with the question of their unit where nothing says it."""
    values, unit = real(part, "frequency"), part.unit
    angular = "angular" in part.roles
    if angular and (not unit or unit in RECIPROCAL_SECONDS):
        return values
    if not unit:
        name = part.column.name[:40]
        raise FileError(
            f"the frequency {name!r} states no unit, and 2π lies between Hz and rad/s; state units {name}=Hz or"
            f" {name}=rad/s",
            "/units",
        )
    found = units.conversion(unit, "rad/s")
    if found is None:
        raise FileError(f"the frequency {part.column.name[:40]!r} is in {unit!r}; give Hz, kHz or rad/s", "/units")
    return values * found[0]


def of_signal(part: Part, signal: Signal, what: str, notes: list[str]) -> FloatArray:
    """The samples of an input or output in the unit of the plant's signal."""
    factor, offset = _to_plant(part, signal.unit, units.parsed(signal.unit), f"the plant's {what}", notes)
    return real(part, what) * factor + part.sign * offset if offset else real(part, what) * factor


def response_factor(part: Part, said: Said, notes: list[str]) -> float:
    """The factor from the unit of a response's column to output over input of the plant."""
    output, over = said.signal("output"), said.signal("input")
    top, bottom = units.parsed(output.unit), units.parsed(over.unit)
    wanted = None
    if top is not None and bottom is not None:
        s, m, kg, a, k, rad = (one - other for one, other in zip(top.dimension, bottom.dimension, strict=True))
        wanted = units.Unit(top.factor / bottom.factor, (s, m, kg, a, k, rad))
    text = f"{output.unit}/{over.unit}" if output.unit and over.unit else ""
    return _to_plant(part, text, wanted, "output over input of the plant", notes)[0]


def _to_plant(part: Part, text: str, wanted: units.Unit | None, what: str, notes: list[str]) -> tuple[float, float]:
    given = units.parsed(part.unit)
    if not part.unit or part.unit.strip() == text.strip():
        return 1.0, 0.0
    name = part.column.name[:40]
    if given is None or wanted is None:
        unusual = given is None or given.factor != 1.0
        if unusual and not part.name.loose:
            why = f"the unit {part.unit[:20]!r} is not known" if given is None else f"no unit is stated for {what}"
            notes.append(f"The values of {name!r} stay as they are in the file: {why}.")
        return 1.0, 0.0
    if given.dimension != wanted.dimension:
        if part.name.loose:
            return 1.0, 0.0
        raise FileError(
            f"{name!r} is in {part.unit[:20]}, {what} in {text}, which is another quantity; correct the plant's unit,"
            f" state units {name}=…, or choose another column",
            "/units",
        )
    return given.factor / wanted.factor, (given.offset - wanted.offset) / wanted.factor
