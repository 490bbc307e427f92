"""The phase of a response as it runs from one frequency to the next, whatever lies between those that are asked."""

from collections.abc import Callable

import numpy as np

from identification.arrays import ComplexArray, FloatArray

PARTS = 8
LARGEST_STEP = np.pi / 3
HALVINGS = 45


def continuous_phase(
    response: Callable[[FloatArray], ComplexArray], omega: FloatArray, dead_time: float = 0.0, memory: float = 0.0
) -> FloatArray:
    """arg G (F,) in rad at ω (F,), in any order: continuous in ω, in (−π, π] without the dead time at the lowest ω.

        arg G(ω) = arg(G(ω) e^{jωD}) − ω D

    The phase of the dead time D (s) is known, however coarse the grid; what is left is that of a finite number of poles
    and zeros [Ljung1999, Section 2.2] and is followed between the frequencies that were asked, in halves where it turns
    by more than a third of π. `memory` n T (s) of a model in discrete time: poles at zero turn it by as much.
    """
    places, at = np.unique(omega, return_inverse=True)
    rest = _followed(lambda w: response(w) * np.exp(1j * w * dead_time), _between(places, memory))
    return np.asarray((rest(places) - places * dead_time)[at])


def _between(places: FloatArray, memory: float) -> FloatArray:
    """The frequencies with so many between them that a phase of slope `memory` is followed."""
    parts = PARTS + np.ceil(np.diff(places) * memory / (LARGEST_STEP / 2)).astype(np.int64)
    inner = [np.linspace(low, high, n, endpoint=False) for low, high, n in zip(places, places[1:], parts, strict=False)]
    return np.concatenate([*inner, places[-1:]])


def _followed(response: Callable[[FloatArray], ComplexArray], omega: FloatArray) -> Callable[[FloatArray], FloatArray]:
    angle = np.angle(response(omega))
    for _ in range(HALVINGS):
        known = np.isfinite(angle)
        omega, angle = omega[known], angle[known]
        wide = abs(_wrapped(np.diff(angle))) > LARGEST_STEP
        middle = (omega[1:] + omega[:-1])[wide] / 2
        middle = middle[(middle > omega[:-1][wide]) & (middle < omega[1:][wide])]
        if not len(middle):
            break
        omega, order = np.unique(np.concatenate([omega, middle]), return_index=True)
        angle = np.concatenate([angle, np.angle(response(middle))])[order]
    turned = angle[0] + np.concatenate([[0.0], np.cumsum(_wrapped(np.diff(angle)))])
    return lambda asked: np.asarray(np.interp(asked, omega, turned))


def _wrapped(angle: FloatArray) -> FloatArray:
    return np.asarray((angle + np.pi) % (2 * np.pi) - np.pi)
