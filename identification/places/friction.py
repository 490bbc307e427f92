"""The sign of a velocity on a time grid."""

import numpy as np

from identification.arrays import FloatArray

ROUNDING = 0.005


def sign(velocity: FloatArray) -> FloatArray:
    """sign v (…, L) as its mean over each step of a periodic time grid, v taken as straight within the step.

        clip(v/w, ±1),   w the larger of half the change of v over the step and 0.005 of its root mean square

    A jump between two samples would otherwise fall on one of them and put its highest lines at the wrong phase.
    """
    change = abs(np.roll(velocity, -1, axis=-1) - np.roll(velocity, 1, axis=-1)) / 4
    rounded = ROUNDING * np.sqrt(np.mean(velocity**2, axis=-1, keepdims=True)) + np.finfo(np.float64).tiny
    return np.asarray(np.clip(velocity / np.maximum(change, rounded), -1.0, 1.0))
