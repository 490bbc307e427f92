"""In a loop plant or controller must answer with a delay; whether the plant may be taken to answer without."""

import numpy as np
from scipy.special import fdtrc

from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.lti.likelihood import delayed
from identification.lti.whiteness import orthonormal
from identification.models.rational import RationalStructure
from identification.outcome import TestResult
from identification.signals import TimeRecord

ORDER, LEVEL, EXACT = 12, 1e-3, 1e-9


def instant_answer(record: TimeRecord) -> TestResult | None:
    """F test of whether u(t) goes with y(t) beyond past inputs and outputs, and the reference where there is one.

    With the reference that is the controller's answer within the sample; without it the plant's or the controller's,
    which no record tells apart. None for a record that is too short, and where nothing of the input is left.
    """
    order = min(ORDER, len(record) // 12)
    if order < 1:
        return None
    past = [delayed(record.input, 1, order), delayed(record.output, 1, order), np.ones((len(record), 1))]
    if record.reference is not None:
        past.append(delayed(record.reference, 0, order + 1))
    q = orthonormal(np.concatenate(past, axis=1)[order:])
    u, y = (_left(q, x[order:]) for x in (record.input, record.output))
    freedom = len(u) - q.shape[1] - 1
    sizes = float(u @ u), float(y @ y)
    if freedom < 1 or sizes[0] <= EXACT**2 * float(record.input @ record.input) or sizes[1] == 0.0:
        return None
    share = min(float(u @ y) ** 2 / (sizes[0] * sizes[1]), 1 - EXACT)
    ratio = share / (1 - share) * freedom
    return TestResult("answer within the sample", ratio, 1.0, float(fdtrc(1, freedom, ratio)))


def _left(q: FloatArray, x: FloatArray) -> FloatArray:
    return np.asarray(x - q @ (q.T @ x))


def require_delay(structure: RationalStructure, record: TimeRecord) -> None:
    """Raises MisuseError for n_k = 0 and a record in a loop whose controller may answer within the sample.

    [Forssell1999, Section 4]. The direct method counts the noise of y(t) into u(t) where both answer at once.
    """
    if not record.feedback or structure.n_k > 0 or not structure.is_discrete:
        return
    found = instant_answer(record)
    if found is None or found.p_value >= LEVEL:
        return
    why = (
        "the controller answers within the sample"
        if record.reference is not None
        else "plant or controller answers within the sample, and without the reference no record tells which"
    )
    raise MisuseError(
        f"with n_k = 0 the loop has no delay and cannot be judged: {why}; choose n_k ≥ 1, or record the reference of a"
        " controller that answers later",
        "structure",
    )
