"""The order of a state-space model: by the error on held-out lines, or by the singular values."""

import numpy as np

from identification.errors import MisuseError, NotIdentifiableError
from identification.signals import FrequencyResponse
from identification.subspace.fit import line_errors, response_size
from identification.subspace.input_matrices import input_matrices
from identification.subspace.method import Method, block_rows_of, highest_order
from identification.subspace.noise import Noise
from identification.subspace.result import OrderTrial

AS_GOOD = 1.05
ROUNDING = 1e-10
NOTHING = 1e-14


def order_table(method: Method, data: FrequencyResponse) -> tuple[OrderTrial, ...]:
    """Models of order 1, 2, … from every second line of the data, judged on the others [Akcay2008, Model Order].

    Orders at which no model is found are left out; raises NotIdentifiableError when there are none.
    """
    used, held_out = data.lines(slice(0, None, 2)), data.lines(slice(1, None, 2))
    if len(held_out) == 0:
        raise NotIdentifiableError("one line cannot show an order; measure more frequencies", "frequencies")
    highest = highest_order(method, used)
    block_rows = block_rows_of(method, highest, used)
    # The bilinear map has to be the same for both halves.
    every = method.domain(data).z
    z, z_held_out = every[::2], every[1::2]
    noise = Noise.of(used, method.weighting)
    found = method.observability(z, used, noise, block_rows, highest)
    trials = []
    for order in range(1, min(highest, found.highest_order) + 1):
        try:
            a, c = found.system(order, method.transition, method.stability)
            b, d = input_matrices(a, c, z, used.matrices, noise)
            inside, outside = line_errors(a, b, c, d, z, used), line_errors(a, b, c, d, z_held_out, held_out)
        except MisuseError:
            continue
        trials.append(
            OrderTrial(
                order,
                float(found.singular_values[order - 1] / found.singular_values[0]),
                float(np.sqrt(np.mean(inside**2))),
                float(np.sqrt(np.mean(outside**2))),
                float(outside.max()),
                bool(abs(np.linalg.eigvals(a)).max() < 1),
            )
        )
    if not trials:
        raise NotIdentifiableError("no order describes these lines; state the order", "order")
    return tuple(trials)


def chosen_order(trials: tuple[OrderTrial, ...], data: FrequencyResponse) -> int:
    """The lowest order whose error on held-out lines is within 5 % of the least, or as small as rounding errors."""
    least = min(trial.held_out_rms_error for trial in trials)
    rounding = ROUNDING * response_size(data)
    return next(trial.order for trial in trials if trial.held_out_rms_error <= max(AS_GOOD * least, rounding))


def order_at_gap(method: Method, data: FrequencyResponse) -> int:
    """The order n with the largest ratio σ_n/σ_{n+1} of singular values [Akcay2008, Algorithm 2, 4]."""
    highest = highest_order(method, data)
    domain, noise = method.domain(data), Noise.of(data, method.weighting)
    found = method.observability(domain.z, data, noise, block_rows_of(method, highest, data), highest)
    sizes = np.maximum(found.singular_values, NOTHING * found.singular_values[0])
    ratios = sizes[:-1] / sizes[1:]
    return int(np.argmax(ratios[:highest])) + 1
