"""Frequency response of an arbitrary record by local polynomials, which take leakage out."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.errors import MisuseError, RangeError
from identification.signals import FrequencyResponse, TimeRecord
from identification.spectral.resolution import require_changing

CHUNK = 4096
MOVED = 7.0


@dataclass(frozen=True)
class LocalPolynomial:
    """Plant and transient as polynomials of the line number over 2n + 1 lines, solved by least squares at each line.

        Y(k + r) = Σ_{s≤R} g_s r^s U(k + r) + Σ_{s≤R} t_s r^s + V(k + r),   |r| ≤ n,   Ĝ(ω_k) = g_0
        σ̂_k² = ‖residual‖²/d · [(KᴴK)⁻¹]_{00},   d = 2n + 1 − 2(R + 1)           [PintelonSchoukens2012, Chapter 7]

    K is the matrix of these equations. At both ends of the band the window is not centred. Lines at ω = 0 and the
    Nyquist frequency are not used. Lines with less input than `threshold` times the largest, or in whose window plant
    and transient cannot be told apart (input too smooth or on too few lines), are left out.

    A record with a period of which it holds P is cut to whole periods; every P-th line is excited, windows are P times
    as wide, and the lines between, where there is no input, show transient and noise.

    Estimates less than 2n + 1 excited lines apart share data and are correlated. `stride` keeps every so-manieth line;
    the default, 2n + 1, makes windows disjoint, so that a χ² or likelihood over the lines is honest; 1 is for drawing.
    Assumes that the input is known exactly, open loop, and noise that is flat over a window. Where a `reference` of the
    loop was recorded, plants from it to u and y are estimated alike and divided, Ĝ = Ĝ_yr/Ĝ_ur, with σ̂² from the
    residual of y − Ĝ u, at the lines where Ĝ_ur stands out of its noise sevenfold: feedback of noise leaves no bias
    [PintelonSchoukens2012, Section 7.3].
    """

    kind: ClassVar[str] = "local_polynomial"

    degree: Annotated[int, "degree R of the polynomials"] = 2
    half_window: Annotated[int, "n: lines on each side of the one estimated"] = 6
    stride: Annotated[int | None, "every so-manieth line is given; 2n + 1 when not stated"] = None
    threshold: Annotated[float, "smallest input amplitude of a line, as a fraction of the largest"] = 1e-3
    continuous_time: Annotated[bool, "the response is that of a continuous-time plant (band-limited measurement)"] = (
        False
    )

    @classmethod
    def example(cls) -> "LocalPolynomial":
        """An instance for tests and catalogues."""
        return cls()

    def __post_init__(self) -> None:
        if self.degree < 0:
            raise RangeError(f"the degree is {self.degree}; it must be zero or more", "degree")
        if self.degrees_of_freedom < 1:
            raise RangeError(
                f"{self.window} lines leave no degree of freedom for {2 * self.degree + 2} unknowns; widen the window",
                "half_window",
            )
        if self.stride is not None and self.stride < 1:
            raise RangeError(f"the stride is {self.stride}; it must be one or more", "stride")
        if not 0 <= self.threshold < 1:
            raise RangeError(f"the threshold is {self.threshold}; it must lie in [0, 1)", "threshold")

    @property
    def window(self) -> int:
        """Excited lines in a window, 2n + 1."""
        return 2 * self.half_window + 1

    @property
    def degrees_of_freedom(self) -> int:
        """d, complex degrees of freedom of each variance where all lines are excited."""
        return self.window - 2 * (self.degree + 1)

    def estimate(self, record: TimeRecord) -> FrequencyResponse:
        """Ĝ with variances at lines of the record; raises MisuseError when it is too short or its input too poor."""
        require_changing(record)
        apart = record.period_count
        samples = len(record) if record.period is None else apart * record.period
        count, half = (samples - 1) // 2, self.half_window * apart
        if count < 2 * half + 1:
            raise MisuseError(
                f"the record of {samples} samples has {count} lines and a window takes {2 * half + 1}; record longer"
                " or narrow the window",
                "half_window",
            )
        u, y = (np.fft.rfft(x[-samples:])[1 : count + 1] for x in (record.input, record.output))
        if not u.any():
            raise MisuseError("the input is constant; no frequency response can be seen", "input")
        stride = self.window if self.stride is None else self.stride
        excited = np.arange(apart - 1, count, apart)
        centres = excited[min(self.half_window if stride > 1 else 0, len(excited) - 1) :: stride]
        reference = None if record.reference is None else np.fft.rfft(record.reference[-samples:])[1 : count + 1]
        parts = [self._windows(u, y, chunk, half, reference) for chunk in _chunks(centres, CHUNK // apart + 1)]
        response, variance, usable = (np.concatenate([part[i] for part in parts]) for i in range(3))
        if not usable.any():
            raise MisuseError(
                "the input excites too few or too smooth lines to tell plant from transient; give the period of the"
                " record or excite every line with random phases",
                "input",
            )
        return FrequencyResponse(
            2 * np.pi * (centres[usable] + 1) / (samples * record.sample_time),
            response[usable],
            record.operating_point,
            None if self.continuous_time else record.sample_time,
            variance[usable],
            float(2 * half + 1 - 2 * (self.degree + 1)),
            held=record.held if self.continuous_time else None,
        )

    def _windows(
        self, u: ComplexArray, y: ComplexArray, centres: IntArray, half: int, reference: ComplexArray | None
    ) -> tuple[ComplexArray, FloatArray, BoolArray]:
        """Ĝ, σ̂² and whether they can be used, at the lines `centres` (K,) of the spectra (F,)."""
        start = np.clip(centres - half, 0, len(u) - 2 * half - 1)
        lines = start[:, None] + np.arange(2 * half + 1)
        powers = ((lines - centres[:, None]) / half)[..., None] ** np.arange(self.degree + 1)
        drive = u if reference is None else reference
        matrix = np.concatenate([powers * drive[lines][..., None], powers + 0j], axis=-1)
        lengths = np.linalg.norm(matrix, axis=1, keepdims=True)
        lengths = np.where(lengths > 0, lengths, 1.0)
        left, values, right = np.linalg.svd(matrix / lengths, full_matrices=False)
        usable = (values[:, -1] > 1e-8 * values[:, 0]) & (abs(drive[centres]) > self.threshold * abs(drive).max())
        inverse = right.conj()[:, :, 0] / np.where(usable[:, None], values, 1.0) / lengths[:, 0, :1]
        of_y, of_u = (np.einsum("kwm,kw->km", left.conj(), x[lines]) for x in (y, u))
        moved = np.sum(inverse * of_u, axis=1) if reference is not None else np.ones(len(centres), dtype=np.complex128)
        if reference is not None:
            left_of_u = u[lines] - np.einsum("kwm,km->kw", left, of_u)
            spread = np.sum(abs(left_of_u) ** 2, axis=1) * np.sum(abs(inverse) ** 2, axis=1)
            usable &= abs(moved) ** 2 > MOVED**2 * spread / (2 * half + 1 - 2 * (self.degree + 1))
        inverse = inverse / np.where(usable, moved, 1.0)[:, None]
        response = np.sum(inverse * of_y, axis=1)
        rest, projected = y[lines], of_y
        if reference is not None:
            rest, projected = rest - response[:, None] * u[lines], of_y - response[:, None] * of_u
        residual = rest - np.einsum("kwm,km->kw", left, projected)
        power = np.sum(abs(residual) ** 2, axis=1) / (2 * half + 1 - 2 * (self.degree + 1))
        floor = np.finfo(np.float64).eps ** 2 * (np.sum(abs(y[lines]) ** 2, axis=1) + np.mean(abs(y) ** 2))
        noise = np.maximum(power, np.maximum(floor, np.finfo(np.float64).tiny))
        return response, noise * np.sum(abs(inverse) ** 2, axis=1), usable


def _chunks(centres: IntArray, size: int) -> Iterator[IntArray]:
    return (centres[i : i + size] for i in range(0, len(centres), size))
