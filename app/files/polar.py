"""Magnitude and phase to complex responses, with the questions that their units raise."""

import numpy as np

from app.files import units
from app.files.assignment import Part
from app.files.contents import FileError
from app.files.conversion import real, response_factor
from app.files.statements import Said
from identification.arrays import ComplexArray, FloatArray

# Names of magnitudes that are often given in dB without a word.
OPEN = ("magnitude", "mag", "gain", "amplitude", "amp", "ampl", "amplitudengang", "verstärkung")


def polar(magnitude: Part, phase: Part, said: Said, notes: list[str]) -> ComplexArray:
    """|G| e^{jφ} in the unit of the plant; raises FileError with the question of a unit that nothing tells."""
    size = magnitudes(magnitude, said, notes)
    angle = _angle(phase, notes)
    if size.shape != angle.shape:
        raise FileError(f"the magnitude has shape {size.shape}, the phase {angle.shape}")
    return np.asarray(size * np.exp(1j * angle))


def magnitudes(part: Part, said: Said, notes: list[str]) -> FloatArray:
    """Magnitudes as ratios: 10^(dB/20) where they are in dB, by their unit or because some are negative."""
    name = part.column.name[:40]
    values = part.sign * real(part, "magnitude")
    if units.is_decibel(part.unit) or "db" in part.name.words[:1] or part.name.plain in ("db", "dbh", "dbg"):
        return np.asarray(10 ** (values / 20))
    if np.any(values < 0):
        if part.unit:
            raise FileError(
                f"the magnitude {name!r} is negative; state its unit, units {name}=dB, if it is in dB", "/units"
            )
        notes.append(f"The magnitudes of {name!r} are taken in dB, as some are negative.")
        return np.asarray(10 ** (values / 20))
    if not part.unit and part.name.plain in OPEN:
        raise FileError(
            f"the magnitude {name!r} states no unit; state units {name}=dB, or {name}=1 for a plain ratio", "/units"
        )
    return np.asarray(values * response_factor(part, said, notes))


def _angle(part: Part, notes: list[str]) -> FloatArray:
    values, name = real(part, "phase"), part.column.name[:40]
    unit = part.unit
    if not unit and _must_be_degrees(values):
        notes.append(f"The phase {name!r} is taken in degrees: it jumps by more than radians can.")
        unit = "deg"
    if not unit:
        raise FileError(f"the phase {name!r} states no unit; state units {name}=deg or {name}=rad", "/units")
    found = units.conversion(unit, "rad")
    if found is None:
        raise FileError(f"the phase {name!r} is in {unit[:20]!r}; give deg or rad", "/units")
    return values * found[0]


def _must_be_degrees(values: FloatArray) -> bool:
    """Whether values can be neither wrapped radians, which stay within ±2π, nor unwrapped ones, whose steps are ≤ π."""
    return bool(np.max(np.abs(values)) > 2 * np.pi and np.any(np.abs(np.diff(values)) > np.pi + 1e-6))
