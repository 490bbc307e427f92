"""Several repeats of one frequency response to their mean and its variance."""

from dataclasses import dataclass

import numpy as np

from app.files.contents import FileError
from identification.arrays import ComplexArray, FloatArray

SAME = 1e-6  # relative difference of frequencies that are one


@dataclass(frozen=True, eq=False)
class Mean:
    """Frequencies (F,) in rad/s, mean responses (F,), their variances E|n|² and complex degrees of freedom."""

    frequencies: FloatArray
    response: ComplexArray
    variance: FloatArray
    degrees_of_freedom: float
    repeats: int


def averaged(omega: FloatArray, response: ComplexArray, labels: FloatArray | None = None) -> Mean:
    """The mean over R repeats Z_r(ω_k) and the variance of that mean, Σ_r |Z_r − Z̄|² / (R (R − 1)), with R − 1 degrees.

    Lines of one frequency, whatever their order in the file, are repeats; `labels` tell them apart where there are
    some. Raises FileError unless each frequency was measured equally often, or where repeats agree exactly.
    """
    order = np.argsort(omega, kind="stable")
    groups = np.concatenate([[0], np.cumsum(np.diff(omega[order]) > SAME * abs(omega[order][1:]))])
    counts = np.bincount(groups)
    if len(set(counts.tolist())) > 1:
        raise FileError(
            f"some frequencies occur {counts.min()} times, others {counts.max()} times; where the file holds several"
            " responses, say which lines are meant with rows, such as rows run=1, or leave lines out"
        )
    repeats = int(counts[0])
    if labels is not None and any(len(set(labels[order][groups == g].tolist())) < repeats for g in range(len(counts))):
        raise FileError("a repeat has a frequency twice; say which lines are meant with rows")
    blocks = response[order].reshape(-1, repeats)
    mean = blocks.mean(axis=1)
    variance = np.sum(abs(blocks - mean[:, None]) ** 2, axis=1) / (repeats * (repeats - 1))
    if np.any(variance <= 0):
        raise FileError("repeats of a frequency agree exactly: they are copies, not measurements; leave them out")
    frequencies = omega[order].reshape(-1, repeats).mean(axis=1)
    return Mean(frequencies, mean, variance, float(repeats - 1), repeats)
