"""Forces that a stage may hide, sized by how far it moves."""

import numpy as np

from benchmarks.campaigns.stage import Law


def coulomb(force: float, v: float) -> Law:
    """F sign(q′), rounded within 1 % of the rms speed."""
    return lambda q, dq: force * np.tanh(dq / (0.01 * v))


def asymmetric(forwards: float, backwards: float, v: float) -> Law:
    """F₊ forwards, F₋ backwards."""
    return lambda q, dq: np.where(dq > 0, forwards, backwards) * np.tanh(dq / (0.01 * v))


def stribeck(force: float, more: float, speed: float, v: float) -> Law:
    """F (1 + more e^{−(q′/speed)²}) sign(q′)."""
    return lambda q, dq: force * (1 + more * np.exp(-((dq / speed) ** 2))) * np.tanh(dq / (0.01 * v))


def power(coefficient: float, exponent: int) -> Law:
    """e qⁿ, n odd."""
    return lambda q, dq: coefficient * q**exponent


def drag(coefficient: float) -> Law:
    """e q′|q′|."""
    return lambda q, dq: coefficient * dq * abs(dq)
