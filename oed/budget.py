"""The best decision that a given energy can buy."""

from dataclasses import replace

import numpy as np

from oed.design import Design, designed
from oed.problem import DesignProblem
from oed.statement import stated

STEPS = 14
NEAR = 0.97
MARGIN = 0.99
LEAST, MOST = 1e-8, 1e8


def within_energy(problem: DesignProblem, energy: float) -> Design:
    """The design whose experiments take at most this energy and reach the largest share of what the targets ask.

    All R_j are multiplied by one factor, found by bisection; the least energy rises with it. The design tells what it
    reaches in `expected_covariance` and `decisions`; its outcome is "infeasible" when no share at all can be reached.
    """
    problem = replace(problem, caps=np.minimum(problem.limits, energy))
    statement = stated(problem)
    best, low, high, share = None, LEAST, MOST, 1.0
    for _ in range(STEPS):
        trial = designed(problem, statement.asking(share))
        if trial.total_energy <= energy:
            low, best = share, trial
            if trial.total_energy >= NEAR * energy:
                break
        else:
            high = share
        share = _next(share, low, high, energy / trial.total_energy if 0 < trial.total_energy < np.inf else 0.0)
    return best if best is not None else trial


def _next(share: float, low: float, high: float, ratio: float) -> float:
    """The share that fits if the energy grows with it; the middle of the bounds where that is not between them."""
    guess = MARGIN * share * ratio
    bounded = low > LEAST and high < MOST
    return guess if low < guess < high and not bounded else float(np.sqrt(low * high))
