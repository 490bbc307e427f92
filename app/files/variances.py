"""What a file says about the noise of a response: variances, deviations, coherence, repeats."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.files.assignment import Part, having, only
from app.files.contents import FileError
from app.files.conversion import real, response_factor
from app.files.statements import Said
from identification.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, eq=False)
class Noise:
    """E|n|² of each value (F,) and the complex degrees of freedom of its estimate; None where it is not known."""

    variance: FloatArray | None = None
    degrees_of_freedom: float | None = None


def noise_of(
    parts: Sequence[Part], response: ComplexArray, averages: int | None, said: Said, notes: list[str]
) -> Noise:
    """What the columns beside a response (F,) say of its noise; `notes` say why not, where they do not suffice.

    Deviations of real and imaginary part add up squared; those of magnitude and phase as σ_m² + |G|² σ_φ²; a single
    one is the root mean square of |n|. Coherence γ² with n independent averages gives |G|² (1 − γ²) / (n γ²), the
    variance of the H1 estimate [PintelonSchoukens2012, Chapter 2], with n − 1 degrees of freedom.
    """
    if variance := only(having(parts, "variance"), "variance"):
        return Noise(real(variance, "variance") * response_factor_squared(variance, said))
    deviations = having(parts, "deviation")
    if deviations:
        return Noise(_of_deviations(deviations, response, said, notes))
    coherence = only(having(parts, "coherence"), "coherence")
    if coherence is None:
        return Noise()
    count = averages or _averages(parts)
    if count is None:
        notes.append("The coherence says nothing of the noise without the number of averages: state averages.")
        return Noise()
    return _of_coherence(coherence, response, count, notes)


def response_factor_squared(part: Part, said: Said) -> float:
    """The square of the factor to the plant's units: variances are stated in squares of the unit of the response."""
    return 1.0 if not part.unit else response_factor(replace(part, unit=part.unit.rstrip("²^2")), said, []) ** 2


def _of_deviations(parts: Sequence[Part], response: ComplexArray, said: Said, notes: list[str]) -> FloatArray | None:
    by_word = {word: part for part in parts for word in part.name.words}
    pairs = {kind: [by_word[w] for w in words if w in by_word] for kind, words in _WORDS.items()}
    if pairs["re"] and pairs["im"]:
        both = [real(one[0], "deviation") * response_factor(one[0], said, notes) for one in (pairs["re"], pairs["im"])]
        return np.asarray(both[0] ** 2 + both[1] ** 2)
    if pairs["magnitude"] and pairs["phase"]:
        size = real(pairs["magnitude"][0], "deviation") * response_factor(pairs["magnitude"][0], said, notes)
        angle = np.radians(real(pairs["phase"][0], "deviation"))
        if pairs["phase"][0].unit in ("deg", "°", "degrees"):
            return np.asarray(size**2 + (abs(response) * angle) ** 2)
        notes.append("The deviations of the phase state no unit; write it as deg to have them taken.")
        return None
    part = only(parts, "deviation")
    assert part is not None, "there are some"
    notes.append(f"The deviation {part.column.name[:40]!r} is taken as the root mean square of the complex error.")
    return np.asarray((real(part, "deviation") * response_factor(part, said, notes)) ** 2)


_WORDS = {
    "re": ("re", "real", "zre", "zreal"),
    "im": ("im", "imag", "zim", "zimag"),
    "magnitude": ("mag", "magnitude", "abs", "mod"),
    "phase": ("phase", "phi", "arg"),
}


def _averages(parts: Sequence[Part]) -> int | None:
    part = only(having(parts, "averages"), "averages")
    if part is None:
        return None
    values = np.atleast_1d(real(part, "averages"))
    return int(values.min()) if values.min() >= 1 else None


def _of_coherence(part: Part, response: ComplexArray, count: int, notes: list[str]) -> Noise:
    squared = real(part, "coherence")
    if np.any(squared < 0) or np.any(squared > 1 + 1e-9):
        raise FileError(f"the coherence {part.column.name[:40]!r} is not between 0 and 1", "/columns")
    if count < 2:
        notes.append("The coherence of a single average is one whatever the noise: it says nothing.")
        return Noise()
    if np.any(squared <= 0) or np.any(squared >= 1):
        notes.append("The coherence is 0 or 1 at some frequencies, where it says nothing; the variances are left out.")
        return Noise()
    variance = abs(response) ** 2 * (1 - squared) / (count * squared)
    return Noise(np.asarray(variance), float(count - 1))
