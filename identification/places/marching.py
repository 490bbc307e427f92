"""Plants with forces followed step after step, where no steady state is found otherwise or none is asked for."""

import numpy as np

from identification.arrays import FloatArray
from identification.places.in_time import PlantsInTime
from identification.places.loop import Loop

MOST_PERIODS, REPEATED = 12, 1e-3


def marched(loop: Loop, plants: PlantsInTime, free: tuple[FloatArray, FloatArray], periods: int = 1) -> FloatArray:
    """The force φ (M, N) on the time grid of a loop, for the motion `free` (q, q̇), each (M, N), without it.

    From rest, over so many `periods` at most, until what is at their end was there one before:

        φ_k = Σ e f(q_k, q̇_k),   (q, q̇)_k = free + C (e^{Ah/2} w_k − Γ(h/2) φ_k),   w_{k+1} = e^{Ah} w_k − Γ(h) φ_k

    with forces that keep their value over the step around each time of the grid, found with their own effect on the
    motion in the middle of it, so that friction holds what it can hold [AcaryBrogliato2008].
    """
    states = np.zeros_like(plants.entry)
    found = np.zeros_like(free[0])
    for _ in range(periods):
        before, states = states, _over_a_period(loop, plants, free, states, found)
        size = np.linalg.norm(states - before, axis=0)
        if np.all(size <= REPEATED * np.linalg.norm(states, axis=0)):
            break
    return found


def _over_a_period(
    loop: Loop, plants: PlantsInTime, free: tuple[FloatArray, FloatArray], states: FloatArray, found: FloatArray
) -> FloatArray:
    """The states (n, M) after a period that begins with some; writes the force into `found` (M, N)."""
    (half, half_pushed), (whole, pushed) = plants.held(0.5), plants.held(1.0)
    by = np.einsum("cim,im->cm", plants.motion, half_pushed) + plants.direct
    to_q, to_flow = np.einsum("cim,ijm->cjm", plants.motion, half)
    q_free, flow_free = (np.ascontiguousarray(one.T) for one in free)
    transition, forces = np.ascontiguousarray(whole), [(effect, e[:, 0]) for effect, e in loop.forces]
    for k, (q, flow) in enumerate(zip(q_free, flow_free, strict=True)):
        q, flow = q + (to_q * states).sum(0), flow + (to_flow * states).sum(0)
        total = np.zeros_like(q)
        for effect, e in forces:
            total += effect.held_against(q - by[0] * total, flow - by[1] * total, e, by)
        found[:, k] = total
        states = (transition * states).sum(1) - pushed * total
    return states
