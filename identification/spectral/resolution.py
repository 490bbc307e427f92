"""What the converter of a sensor does to a record: its step, and whether the record shows the plant at all."""

from collections.abc import Sequence

import numpy as np
from scipy.special import fdtrc

from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.signals import Measurement, TimeRecord

MOST_LEVELS, MOST_SAMPLES, MOST_PEAKS = 16384, 20000, 40
SHARP = 0.7
FROZEN = 0.25
UNRELATED = 1e-3


def converter_step(signal: FloatArray) -> float:
    """The step q of the grid on which the values of a signal (N,) stand, or around which they are scattered; 0: none.

        |1/N Σ_t e^{2πi y_t/q}| = e^{−2π²σ²/q²} for noise σ ≪ q added behind the converter, 1 without; small off a grid

    The coarsest q of at least three steps in the range of the signal, and no more than one for two samples; none where
    there are two values only, which may be those of the signal itself [WidrowKollar2008, Section 4].
    """
    values = (signal - signal.min())[:: max(1, len(signal) // MOST_SAMPLES)]
    span = float(values.max())
    if span <= 64 * np.finfo(np.float64).eps * float(abs(signal).max()):
        return 0.0
    bins = 4 * min(MOST_LEVELS, 2 ** int(np.log2(4 * max(len(values), 2))))
    counts = np.bincount((values / span * (bins // 4 - 1)).astype(np.int64), minlength=bins).astype(np.float64)
    coarse = abs(np.fft.rfft(counts)) / len(values)
    most = min(len(coarse) - 1, 2 * len(values))
    peaks = [f for f in range(12, most) if coarse[f] > SHARP / 2 and coarse[f] >= max(coarse[f - 1], coarse[f + 1])]
    for f in peaks[:MOST_PEAKS]:
        fine = (f + np.linspace(-1.5, 1.5, 61)) * (bins // 4 - 1) / (bins * span)
        sharp = abs(np.exp(2j * np.pi * np.outer(fine, values)).mean(axis=1))
        if sharp.max() > SHARP:
            step = float(1 / fine[np.argmax(sharp)])
            return step if len(np.unique(np.round(values / step))) > 2 else 0.0
    return 0.0


def repeated_error(step: float, deviation: float) -> float:
    """The variance of the rounding error to a grid of this step that comes again in every period.

    q²/12 · e^{−4π²σ²/q²},   σ the deviation of the noise between periods, which dithers [WidrowKollar2008, Section 5]
    """
    return 0.0 if step == 0 else float(step**2 / 12 * np.exp(-4 * np.pi**2 * deviation**2 / step**2))


def check_changing(experiments: Sequence[Measurement]) -> None:
    """Raises MisuseError, naming the experiment by number and place, for the first record that shows no plant."""
    for i, one in enumerate(experiments):
        if not isinstance(one, TimeRecord):
            continue
        try:
            require_changing(one)
        except MisuseError as error:
            where = ", ".join(f"{value:g}" for value in one.operating_point)
            raise MisuseError(f"experiment {i + 1}, at {where}: {error}", "experiments") from error


def require_changing(record: TimeRecord) -> None:
    """Raises MisuseError where the output of a record is stuck, frozen or only flickers, so that it shows no plant.

    Stuck: one value throughout. Frozen: the same value for a quarter of the record or a period, while the input
    changes. Flickering: two values, and which of them has nothing to do with the input.
    """
    u, y = record.input, record.output
    if np.ptp(y) <= 4 * np.finfo(np.float64).eps * float(abs(y).max()) and np.ptp(u) > 0:
        raise MisuseError(f"the output is {y[0]:g} at every sample; check the sensor and its connection", "output")
    if _frozen(record):
        raise MisuseError(
            "the output stands at one value for a long time while the input changes; the sensor or the logger froze:"
            " measure again, or cut the record",
            "output",
        )
    if len(np.unique(y)) == 2 and not _follows(record):
        raise MisuseError(
            f"the output only flickers between {y.min():g} and {y.max():g}, whatever the input does; check the sensor",
            "output",
        )


def _frozen(record: TimeRecord) -> bool:
    """A long run of one value, not at the start, where a plant may still be at rest, while the input moves."""
    y, u = record.output, record.input
    ends = np.flatnonzero(np.diff(y) != 0)
    edges = np.concatenate([[0], ends + 1, [len(y)]])
    lengths = np.diff(edges)
    longest = int(np.argmax(lengths[1:])) + 1 if len(lengths) > 1 else 0
    if longest == 0 or lengths[longest] < FROZEN * len(y):
        return False
    run = u[edges[longest] : edges[longest + 1]]
    return bool(np.std(run) > 0.1 * np.std(u))


def _follows(record: TimeRecord) -> bool:
    """Whether an output of two values depends on the input of the same or of the last samples (F test)."""
    u, y = record.input - record.input.mean(), record.output - record.output.mean()
    lags = min(20, len(u) // 8)
    rows = np.stack([u[lags - i : len(u) - i] for i in range(lags + 1)], axis=1)
    target = y[lags:]
    found = np.linalg.lstsq(rows, target, rcond=None)[0]
    left = float(np.sum((target - rows @ found) ** 2))
    freedom = len(target) - lags - 1
    if left <= 1e-12 * float(np.sum(target**2)) or freedom < 1:
        return True
    ratio = (float(np.sum(target**2)) - left) / (lags + 1) / (left / freedom)
    return bool(fdtrc(lags + 1, freedom, ratio) < UNRELATED)
