"""What a force puts beyond the Nyquist frequency, as samples of the output show it."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.models.structure import Structure


def aliases(
    force: FloatArray, differentiated: bool, structure: Structure, zeta: FloatArray, batch: Batch
) -> ComplexArray:
    """Lines (M, K) that −G F at the frequencies above Nyquist's fold onto, for f (M, L·n) on a finer time grid.

        ω_k = 2πk/(L T), L/2 < k < L n/2:   line k mod L, or its conjugate at −k mod L

    [PintelonSchoukens2012, Section 2.2].

    F are the lines of f, or of its rate where that is the force.
    """
    found = np.zeros_like(batch.inputs)
    assert batch.signals is not None
    length = batch.signals.shape[-1]
    k = np.arange(length // 2 + 1, force.shape[-1] // 2)
    if len(k) == 0 or batch.sample_time is None:
        return found
    omega = 2 * np.pi * k / (length * batch.sample_time)
    lines = np.fft.rfft(force)[:, k] / force.shape[-1] * (1j * omega if differentiated else 1.0)
    seen = -lines * structure.plant_response(zeta, omega)
    for at, values in ((k % length, seen), (-k % length, seen.conj())):
        onto = at < found.shape[1]
        np.add.at(found.T, at[onto], values[:, onto].T)
    return found
