"""The steps that the subspace estimators share."""

import numpy as np

from identification.arrays import FloatArray
from identification.models.system import StateSpace
from identification.outcome import Outcome
from identification.signals import FrequencyResponse
from identification.subspace.fit import line_errors, response_size
from identification.subspace.input_matrices import input_matrices
from identification.subspace.method import Method, block_rows_of, require_positive
from identification.subspace.noise import Noise
from identification.subspace.orders import NOTHING, chosen_order, order_at_gap, order_table
from identification.subspace.result import OrderTrial, SubspaceEstimate

__all__ = ["SubspaceEstimate", "estimate"]


def estimate(method: Method, data: FrequencyResponse) -> SubspaceEstimate:
    """The steps of both algorithms: order, observability range, A and C, B and D, errors."""
    require_positive(method)
    if np.any(np.diff(data.frequencies) < 0):
        data = data.lines(np.argsort(data.frequencies))
    size = response_size(data)
    trials: tuple[OrderTrial, ...] = ()
    order = method.order
    if method.order_table or (order is None and method.order_rule == "held_out"):
        trials = order_table(method, data)
    if order is None:
        by_gap = method.order_rule == "singular_values"
        order = order_at_gap(method, data) if by_gap else chosen_order(trials, data)
    block_rows = block_rows_of(method, order, data)
    domain, noise = method.domain(data), Noise.of(data, method.weighting)
    found = method.observability(domain.z, data, noise, block_rows, order)
    a, c = found.system(order, method.transition, method.stability)
    b, d = input_matrices(a, c, domain.z, data.matrices, noise)
    errors = line_errors(a, b, c, d, domain.z, data)
    model = domain.model(a, b, c, d)
    rms = float(np.sqrt(np.mean(errors**2)))
    outcome = Outcome("converged", _advice(model, found.singular_values), 1)
    return SubspaceEstimate(
        model,
        data.operating_point,
        outcome,
        found.singular_values,
        block_rows,
        float(errors.max()),
        rms,
        rms / size,
        trials,
    )


def _advice(model: StateSpace, singular_values: FloatArray) -> str:
    shown = int(np.sum(singular_values > NOTHING * singular_values[0]))
    texts = (
        (not model.stable, "the model is unstable; use the stability 'projection', or another order"),
        (model.order > shown, f"the data show order {shown} only, the rest describes rounding errors"),
    )
    return "; ".join(text for holds, text in texts if holds)
