"""Hysteresis without loops over time: states of play and Dahl elements, composed pairwise over a period."""

import numpy as np

from identification.arrays import FloatArray


def play(x: FloatArray, half_width: float) -> FloatArray:
    """Output (…, L) of a play of ± `half_width` for a periodic x (…, L).

        z_t = min(max(z_{t−1}, x_t − w), x_t + w)

    Clamps composed with clamps are clamps, so that all prefixes follow in log₂ L steps; the state at the end of the
    period, whatever it was before, is taken for the start of the next.
    """
    low, high = x - half_width, x + half_width
    shift, length = 1, x.shape[-1]
    while shift < length:
        later = (low[..., shift:].copy(), high[..., shift:].copy())
        low[..., shift:] = np.clip(low[..., :-shift].copy(), *later)
        high[..., shift:] = np.clip(high[..., :-shift].copy(), *later)
        shift *= 2
    first = np.clip(0.0, low[..., -1:], high[..., -1:])
    return np.asarray(np.clip(first, low, high))


def dahl(x: FloatArray, travel: float) -> FloatArray:
    """The state z (…, L), |z| ≤ 1, of a Dahl element (Bouc–Wen with n = 1, γ = 0) for a periodic x (…, L).

    dz = (dx − |dx| z)/δ,   δ = `travel`, the way after which the force has turned
    """
    step = np.diff(x, axis=-1, prepend=x[..., -1:]) / travel
    keep = np.exp(-abs(step))
    gain = np.sign(step) * (1 - keep)
    shift, length = 1, x.shape[-1]
    while shift < length:
        gain[..., shift:] = gain[..., shift:] + keep[..., shift:] * gain[..., :-shift].copy()
        keep[..., shift:] = keep[..., shift:] * keep[..., :-shift].copy()
        shift *= 2
    first = gain[..., -1:] / np.maximum(1 - keep[..., -1:], 1e-12)
    return np.asarray(gain + keep * first)
