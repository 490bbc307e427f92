"""Time columns to a sample time: rounded, jittering, drifting, counted, or at odds with what was stated."""

from dataclasses import dataclass

import numpy as np

from app.files.contents import FileError
from identification.arrays import FloatArray

SAMPLE_TIME_TOLERANCE = 1e-3
SHORTEST, LONGEST = 1e-15, 1e15  # sample times in seconds
UNNOTICED = 0.01  # deviations from a uniform grid, in samples
SMALL_JITTER = 0.1  # root mean square of what is resampled, in samples
GAP = 1.5  # a step of more samples is a gap


@dataclass(frozen=True, eq=False)
class Sampling:
    """The sample time in s, and where samples are to be interpolated at: `stamps`, in samples from the first, at which
    they were taken; None where they lie on the grid. `notes`: what is to be said about it."""

    sample_time: float
    stamps: FloatArray | None = None
    notes: tuple[str, ...] = ()

    def on_grid(self, samples: FloatArray) -> FloatArray:
        """Samples (N, …) taken at the stamps, interpolated by cubic splines at whole numbers of sample times."""
        if self.stamps is None:
            return samples
        from scipy.interpolate import CubicSpline

        result: FloatArray = CubicSpline(self.stamps, samples)(np.arange(len(samples)).astype(np.float64))
        return result


def sampling(time: FloatArray | None, found: float | None, stated: float | None, has_unit: bool = True) -> Sampling:
    """The sampling of a record from its time column (N,) in s, the sample time that the file names, and the stated one.

    What is stated goes first, but not against a file that says another: only time columns without a unit (`has_unit`
    False) may be counted in samples, or in another unit of time. Raises FileError where nothing says the sample time,
    samples are missing, time runs back, or the jitter is more than interpolation may mend.
    """
    seen = None if time is None else uniform(time)
    step = found if seen is None else seen.sample_time
    if stated is None:
        if step is None:
            raise FileError("the file has no time; state sampleTimeSeconds")
        if not SHORTEST <= step <= LONGEST:
            raise FileError(f"the sample time of the file, {step:g} s, is not between {SHORTEST} and {LONGEST} s")
        return seen or Sampling(step)
    if step is None or abs(step / stated - 1) <= SAMPLE_TIME_TOLERANCE:
        return Sampling(stated) if seen is None else Sampling(stated, seen.stamps, seen.notes)
    if time is not None and not has_unit and seen is not None and _another_unit(step / stated, step):
        note = f"The time of the file advances by {step:g} a sample; the stated sample time, {stated:g} s, is taken."
        return Sampling(stated, seen.stamps, (*seen.notes, note))
    resolution = 0.0 if time is None else _resolution(time) / max(len(time) - 1, 1)
    if abs(step - stated) <= resolution:
        return Sampling(stated, None, () if seen is None else seen.notes)
    raise FileError(f"the file was sampled every {step:g} s, but sampleTimeSeconds is {stated:g}")


def _another_unit(ratio: float, step: float) -> bool:
    """Whether a time column counts samples, or is in ms, µs, ns, min or h."""
    near = [abs(ratio / unit - 1) <= SAMPLE_TIME_TOLERANCE for unit in (1e3, 1e6, 1e9, 1 / 60, 1 / 3600)]
    return any(near) or abs(step - 1) < 1e-9


def uniform(time: FloatArray) -> Sampling:
    """The grid nearest to time stamps t_k (N,): t_0 + kT by least squares; raises FileError when they are on none.

    Stamps may be off the grid by what they were rounded to (decimal places or single precision), unnoticed. What is
    off by more is jitter and drift: it is interpolated at, and said, where it is small.
    """
    steps = np.diff(time)
    if len(steps) == 0:
        raise FileError("a record needs at least two samples")
    index = np.arange(len(time)) - (len(time) - 1) / 2
    slope = float(index @ (time - time.mean()) / (index @ index))
    if not slope > 0:
        raise _changing(steps)
    off = (time - time.mean() - slope * index) / slope
    resolution = _resolution(time) / slope
    error = resolution / len(time)
    if np.max(np.abs(off)) <= UNNOTICED:
        return Sampling(simplest(float((time[-1] - time[0]) / len(steps)), min(error, UNNOTICED / len(time))))
    if np.max(np.abs(off)) <= 0.8 * resolution and np.std(off) <= 0.35 * resolution:
        return Sampling(simplest(slope, error), None, _rounded(resolution, error))
    if np.min(steps) <= 0 or np.max(steps) > GAP * slope:
        raise _changing(steps)
    return _resampled(time, slope, off)


def _resampled(time: FloatArray, slope: float, off: FloatArray) -> Sampling:
    jitter = float(np.std(np.diff(off)) / np.sqrt(2))
    drift = float(np.ptp(off))
    if jitter > SMALL_JITTER:
        raise FileError(
            f"the sample time jitters by {100 * jitter:.0f} % of itself (root mean square); resample the record, or"
            " measure with a steady clock"
        )
    note = f"The time stamps jitter by {100 * jitter:.2g} % of the sample time (root mean square)"
    if drift > 1 and drift > 10 * jitter:
        note += f" and drift by {drift:.2g} samples over the record: the clock was not steady"
    steady = abs(off[[0, -1]]).max() < 0.5
    step = slope if steady else float((time[-1] - time[0]) / (len(time) - 1))
    start = time.mean() - slope * (len(time) - 1) / 2 if steady else time[0]
    stamps = (time - start) / step
    return Sampling(step, stamps, (f"{note}; the record was interpolated at multiples of {step:.6g} s.",))


def _rounded(resolution: float, error: float) -> tuple[str, ...]:
    if resolution <= 0.1:
        return ()
    return (
        f"The time stamps are rounded to {resolution:.2g} sample times; the sample time found from all of them is known"
        f" to about {100 * error:.2g} %; state sampleTimeSeconds where you know it better.",
    )


def _changing(steps: FloatArray) -> FileError:
    return FileError(
        f"the sample time changes between {steps.min():g} and {steps.max():g} s within the record: samples are missing"
        " or time runs back; bring in the parts one by one, or resample it"
    )


def simplest(step: float, error: float) -> float:
    """The sample time, or one over a rate, of fewest digits among those within a relative error of the one found."""
    for digits in range(1, 12):
        for value in (float(f"{step:.{digits}g}"), 1 / float(f"{1 / step:.{digits}g}")):
            if abs(value / step - 1) <= error:
                return value
    return step


def _resolution(time: FloatArray) -> float:
    """What stamps are rounded to: the finest decimal place they use, or that of single or double precision."""
    largest = float(np.max(np.abs(time)))
    if largest == 0:
        return 0.0
    double = float(np.spacing(largest))
    single = float(np.spacing(np.float32(largest)))
    decimal = next(
        (10.0**-places for places in range(-3, 13) if np.all(_is_whole(time * 10.0**places, largest * 10.0**places))),
        0.0,
    )
    is_single = bool(np.all(np.abs(time - time.astype(np.float32)) <= 0.02 * single))
    return max(single if is_single else 0.0, decimal, double)


def _is_whole(values: FloatArray, largest: float) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    whole: np.ndarray[tuple[int, ...], np.dtype[np.bool_]] = abs(values - np.round(values)) <= 1e-9 + 4e-16 * largest
    return whole
