"""Whether the clock of the outputs runs fast or slow against that of the inputs, from the periods alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.resampling import FINER, interpolated
from identification.errors import MisuseError
from identification.signals import Measurement, TimeRecord
from identification.spectral.periodic_average import excited_lines, transient_periods

LARGEST = 0.006
MOST_RECORDS, MOST_LINES, TURNS = 16, 200, 8
GAIN, EXPLAINED, ALONE = 30.0, 0.8, 0.5
ROUNDS = 8


@dataclass(frozen=True, eq=False)
class _Periods:
    """Spectra (P, K) of the last P periods at K lines, the numbers of the periods (P,) and the orders of the lines."""

    spectra: ComplexArray
    number: FloatArray
    order: FloatArray

    def aligned(self, skew: float) -> ComplexArray:
        """The spectra turned back by a clock that runs faster by the share `skew`."""
        return np.asarray(self.spectra * np.exp(-2j * np.pi * skew * np.multiply.outer(self.number, self.order)))

    def left(self, skew: float) -> float:
        """By how much the aligned periods differ: Σ |Y_p − Ȳ|²."""
        spectra = self.aligned(skew)
        return float(np.sum(abs(spectra - spectra.mean(axis=0)) ** 2))

    @property
    def freedom(self) -> float:
        """Real degrees of freedom of that."""
        return 2.0 * (len(self.number) - 1) * len(self.order)


def clock_of(experiments: Sequence[Measurement]) -> float:
    """ε of one clock for all periodic records with y((1 + ε) t) in place of y(t); 0 where none is seen.

        max over ε of −Σ_m n_m ln Σ_pk |Y_mpk e^{−jω_k ε t_p} − mean over p|²,   n_m = 2 K_m (P_m − 1)

    the likelihood of periods that differ by noise of unknown size and by a phase that grows with frequency and time.
    Seen where −2 ln L falls by more than `GAIN` and the phase takes up most of what the periods differ by beyond what
    is not in proportion to time; a plant that drifts turns its lines otherwise [PintelonSchoukens2012, Section 2.4].
    """
    records = [one for one in experiments if isinstance(one, TimeRecord) and _repeats(one)]
    whole = [_periods(one, 0) for one in records]
    if not whole:
        return 0.0
    later = [_periods(one, 1 if one.period_count > 2 else 0) for one in records]
    skew = _best(later)
    steady = [_without_transient(one, skew) for one in whole]
    skew = _best(steady, skew)
    return skew if _seen(steady, skew) else 0.0


def _repeats(record: TimeRecord) -> bool:
    """Whether a record has whole periods, with an input that is the same in all of them."""
    if record.period is None or record.period_count < 2 or record.feedback:
        return False
    periods = record.input[: record.period_count * record.period].reshape(-1, record.period)
    return bool(np.ptp(periods, axis=0).max() <= 1e-9 * abs(periods).max())


def _periods(record: TimeRecord, dropped: int) -> _Periods:
    assert record.period is not None
    count = record.period_count
    u, y = (x[: count * record.period].reshape(count, -1) for x in (record.input, record.output))
    spectra = np.fft.rfft(y)
    lines = np.flatnonzero(excited_lines(np.fft.rfft(u), 1e-3))
    lines = lines[(lines > 0) & (2 * lines < record.period)]
    energy = np.sum(abs(spectra[:, lines]) ** 2, axis=0)
    lines = np.sort(lines[np.argsort(energy)[-MOST_LINES:]])
    number = np.arange(dropped, count, dtype=np.float64) + 0.5
    return _Periods(spectra[dropped:, lines], number, lines.astype(np.float64))


def _without_transient(one: _Periods, skew: float) -> _Periods:
    aligned = one.aligned(skew)
    dropped = transient_periods(aligned - aligned.mean(axis=0))
    return _Periods(one.spectra[dropped:], one.number[dropped:], one.order)


def _likelihood(periods: Sequence[_Periods], skew: float) -> float:
    tiny = float(np.finfo(np.float64).tiny)
    return sum(one.freedom * float(np.log(max(one.left(skew), tiny))) for one in periods)


def _best(periods: Sequence[_Periods], near: float | None = None) -> float:
    """ε of the largest likelihood: on a grid over the whole range, or `near` a value, then between its points."""
    chosen = [one for one in periods if len(one.order)][:MOST_RECORDS]
    if not chosen:
        return 0.0
    step = 1 / (TURNS * max(float(one.order[-1] * len(one.number)) for one in chosen))
    count = int(np.ceil(LARGEST / step))
    grid = step * np.arange(-count, count + 1) if near is None else near + step * np.arange(-2, 3) / 2
    for _ in range(6):
        values = np.array([_likelihood(chosen, float(skew)) for skew in grid])
        best = int(np.clip(np.argmin(values), 1, len(grid) - 2))
        grid = np.linspace(grid[best - 1], grid[best + 1], 9)
    return float(grid[4])


def _seen(periods: Sequence[_Periods], skew: float) -> bool:
    if _likelihood(periods, 0.0) - _likelihood(periods, skew) < GAIN:
        return False
    explained = left = 0.0
    for one in periods:
        after = one.left(skew)
        noise = _apart_from_time(one.aligned(skew))
        size = after / one.freedom if noise is None else noise
        explained += (one.left(0.0) - after) / size
        left += (after if noise is None else max(after - size * one.freedom, 0.0)) / size
    alone = all(len(one.number) < 3 for one in periods)
    return explained >= (ALONE if alone else EXPLAINED) * (explained + left)


def _apart_from_time(spectra: ComplexArray) -> float | None:
    """What periods (P, K) differ by for each degree of freedom, but for a straight line over time; None for two."""
    count = len(spectra)
    if count < 3:
        return None
    time = np.stack([np.ones(count), np.arange(count) - (count - 1) / 2])
    time /= np.linalg.norm(time, axis=1, keepdims=True)
    energy = float(np.sum(abs(spectra) ** 2)) - float(np.sum(abs(time @ spectra) ** 2))
    each: float = energy / (2 * (count - 2) * spectra.shape[1])
    return max(each, float(np.finfo(np.float64).tiny))


@dataclass(frozen=True, eq=False)
class Turned:
    """What a clock does to the periodic part s of an output, y = s((1 + ε) t) + noise.

    `period` s (L,) on the clock of the input; `moved` s((1 + ε) t) − s(t) (samples,); `skew` ε.
    """

    period: FloatArray
    moved: FloatArray
    skew: float

    def turned_back(self, spectra: ComplexArray, first: int) -> ComplexArray:
        """Spectra (P, K) of periods less `moved`, from the number `first` on, their noise turned back by the clock.

        So the noise has no mean over the periods that the fit of s has not taken up.
        """
        steady = np.fft.rfft(self.period) / len(self.period)
        number = first + np.arange(len(spectra)) + 0.5
        back = np.exp(-2j * np.pi * self.skew * np.multiply.outer(number, np.arange(len(steady))))
        return np.asarray(steady + (spectra - steady) * back)


def turned(record: TimeRecord, skew: float) -> Turned:
    """The periodic part of the output at the excited lines, and ε, begun at `skew`, by steps of Gauss and Newton.

    s is the mean of what the periods show once they are turned back, less what their ends leak into neighbouring lines.
    The first of more than two periods, which may still be settling, is left out of both.
    """
    if record.period is None:
        raise MisuseError("the record has no period; state the samples per period", "period")
    length, count = record.period, record.period_count
    dropped = 1 if count > 2 else 0
    chosen = slice(dropped * length, count * length)
    middle = (np.arange(dropped, count) + 0.5) * length
    omega = 2 * np.pi * np.fft.rfftfreq(length)
    used = excited_lines(np.fft.rfft(record.input[: count * length].reshape(count, -1)), 1e-3)
    lines = np.zeros(len(omega), dtype=np.complex128)
    at = np.arange(len(record.output), dtype=np.float64)
    for _ in range(ROUNDS):
        value, rate = at_positions(lines, length, (1 + skew) * at)
        left = (record.output - value)[chosen].reshape(-1, length)
        tangent = (at * rate)[chosen].reshape(-1, length)
        left, tangent = left - left.mean(axis=0), tangent - tangent.mean(axis=0)
        size = float(np.sum(tangent**2))
        skew += float(np.sum(tangent * left)) / size if size > 0 else 0.0
        value, _ = at_positions(lines, length, (1 + skew) * at)
        rest = np.fft.rfft((record.output - value)[chosen].reshape(-1, length))
        back = np.exp(-1j * skew * np.multiply.outer(middle, omega))
        lines = lines + np.where(used, np.mean(rest * back, axis=0), 0.0)
    value = at_positions(lines, length, (1 + skew) * at)[0]
    period = np.fft.irfft(lines, n=length)
    return Turned(period, value - np.resize(period, len(at)), skew)


def at_positions(lines: ComplexArray, length: int, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A signal of `length` samples with lines rfft and its derivative by samples, at positions (N,)."""
    lines = lines.copy()
    if length % 2 == 0:
        lines[-1] /= 2
    fine = np.fft.irfft(FINER * lines, n=FINER * length)
    slope = np.fft.irfft(2j * np.pi / length * np.arange(len(lines)) * lines, n=FINER * length)
    value, rate = interpolated(fine, slope, FINER * at, True)
    return value, FINER * rate
