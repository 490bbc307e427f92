"""What the subspace estimators return, and the steps that they share."""

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.outcome import Outcome
from identification.resolvent import resolvent
from identification.signals import FrequencyResponse, OperatingPoint
from identification.state_space import StateSpace
from identification.subspace.domain import Domain
from identification.subspace.input_matrices import input_matrices
from identification.subspace.noise import Noise, Weighting
from identification.subspace.observability import ObservabilityRange
from identification.subspace.transition import Stability, Transition

OrderRule = Literal["held_out", "singular_values"]

MOST_ORDERS = 20
AS_GOOD = 1.05
ROUNDING = 1e-10
NOTHING = 1e-14
EXTREME = 1e100


@dataclass(frozen=True)
class OrderTrial:
    """One row of the table of orders: a model from every second line, judged on the lines between them.

    `rms_error` on the lines used; `held_out_rms_error` and `held_out_max_error` on the others, in units of the
    response; `singular_value`, the one that the order adds, relative to the largest.
    """

    order: int
    singular_value: float
    rms_error: float
    held_out_rms_error: float
    held_out_max_error: float
    stable: bool


@dataclass(frozen=True, eq=False)
class SubspaceEstimate:
    """A state-space model of a frequency response, and how well it describes it.

        max_error = max_k ‖Ĝ_k − G(ω_k)‖_F,   rms_error = √(1/F Σ_k ‖Ĝ_k − G(ω_k)‖_F²)   [Akcay2008, Quality measures]

    `relative_error` is rms_error/√(1/F Σ‖Ĝ_k‖_F²); `singular_values`, largest first, are those that show the order;
    `block_rows` q; `orders`: the table of orders, empty unless it was asked for or needed.
    """

    model: StateSpace
    operating_point: OperatingPoint
    outcome: Outcome
    singular_values: FloatArray
    block_rows: int
    max_error: float
    rms_error: float
    relative_error: float
    orders: tuple[OrderTrial, ...] = ()


class Method(Protocol):
    """What the shared steps need to know of an estimator."""

    @property
    def order(self) -> int | None:
        """n, None to choose it."""

    @property
    def max_order(self) -> int | None:
        """The highest order in the table."""

    @property
    def order_rule(self) -> OrderRule:
        """How the order is chosen."""

    @property
    def order_table(self) -> bool:
        """Whether to make the table for a given order too."""

    @property
    def block_rows(self) -> int | None:
        """q."""

    @property
    def weighting(self) -> Weighting:
        """The weighting of lines."""

    @property
    def transition(self) -> Transition:
        """How A is found."""

    @property
    def stability(self) -> Stability:
        """How A is kept stable."""

    @property
    def zero_order_hold(self) -> bool:
        """Whether to undo a hold."""

    def domain(self, data: FrequencyResponse) -> Domain:
        """The place of the lines on the unit circle."""

    def default_block_rows(self, order: int, data: FrequencyResponse) -> int:
        """q where it is not given."""

    def most_orders(self, block_rows: int | None, data: FrequencyResponse) -> int:
        """The highest order that these lines, and q where it is given, allow."""

    def require_sizes(self, order: int, block_rows: int, data: FrequencyResponse) -> None:
        """Raises where there are too few lines for n and q."""

    def observability(
        self, z: ComplexArray, data: FrequencyResponse, noise: Noise, block_rows: int, order: int
    ) -> ObservabilityRange:
        """The range of the observability matrix."""


def estimate(method: Method, data: FrequencyResponse) -> SubspaceEstimate:
    """The steps of both algorithms: order, observability range, A and C, B and D, errors."""
    _check(method)
    if np.any(np.diff(data.frequencies) < 0):
        data = data.lines(np.argsort(data.frequencies))
    size = _size(data)
    trials: tuple[OrderTrial, ...] = ()
    order = method.order
    if method.order_table or (order is None and method.order_rule == "held_out"):
        trials = order_table(method, data)
    if order is None:
        by_gap = method.order_rule == "singular_values"
        order = order_at_gap(method, data) if by_gap else chosen_order(trials, data)
    block_rows = _block_rows(method, order, data)
    domain, noise = method.domain(data), Noise.of(data, method.weighting)
    found = method.observability(domain.z, data, noise, block_rows, order)
    a, c = found.system(order, method.transition, method.stability)
    b, d = input_matrices(a, c, domain.z, data.matrices, noise)
    errors = _errors(a, b, c, d, domain.z, data)
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


def order_table(method: Method, data: FrequencyResponse) -> tuple[OrderTrial, ...]:
    """Models of order 1, 2, … from every second line of the data, judged on the others [Akcay2008, Model Order].

    Orders at which no model is found are left out; raises NotIdentifiableError when there are none.
    """
    used, held_out = data.lines(slice(0, None, 2)), data.lines(slice(1, None, 2))
    if len(held_out) == 0:
        raise NotIdentifiableError("one line cannot show an order; measure more frequencies", "frequencies")
    highest = _highest_order(method, used)
    block_rows = _block_rows(method, highest, used)
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
            inside, outside = _errors(a, b, c, d, z, used), _errors(a, b, c, d, z_held_out, held_out)
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
    rounding = ROUNDING * _size(data)
    return next(trial.order for trial in trials if trial.held_out_rms_error <= max(AS_GOOD * least, rounding))


def order_at_gap(method: Method, data: FrequencyResponse) -> int:
    """The order n with the largest ratio σ_n/σ_{n+1} of singular values [Akcay2008, Algorithms 1 and 2, step 4 or 5]."""
    highest = _highest_order(method, data)
    domain, noise = method.domain(data), Noise.of(data, method.weighting)
    found = method.observability(domain.z, data, noise, _block_rows(method, highest, data), highest)
    sizes = np.maximum(found.singular_values, NOTHING * found.singular_values[0])
    ratios = sizes[:-1] / sizes[1:]
    return int(np.argmax(ratios[:highest])) + 1


def _highest_order(method: Method, data: FrequencyResponse) -> int:
    if method.max_order is not None:
        return method.max_order
    return min(max(MOST_ORDERS, method.order or 0), method.most_orders(method.block_rows, data))


def _size(data: FrequencyResponse) -> float:
    """√(1/F Σ ‖Ĝ_k‖_F²); raises RangeError where it cannot be computed with."""
    largest = float(abs(data.response).max())
    if largest == 0:
        raise RangeError("the response is zero at every frequency; check the measurement", "response")
    if not 1 / EXTREME < largest < EXTREME:
        raise RangeError(f"the response is of size {largest:.1g}; state it in other units", "response")
    return float(np.linalg.norm(data.response) / np.sqrt(len(data)))


def _check(method: Method) -> None:
    for name in ("order", "max_order", "block_rows"):
        value = getattr(method, name)
        if value is not None and value < 1:
            raise RangeError(f"{name} is {value}; it must be one or more", name)


def _block_rows(method: Method, order: int, data: FrequencyResponse) -> int:
    rows = method.default_block_rows(order, data) if method.block_rows is None else method.block_rows
    if method.block_rows is not None and rows <= order:
        raise RangeError(
            f"{rows} block rows cannot show order {order}; take at least {order + 1}, or a lower order", "block_rows"
        )
    method.require_sizes(order, max(rows, order + 1), data)
    return max(rows, order + 1)


def _errors(
    a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray, z: ComplexArray, data: FrequencyResponse
) -> FloatArray:
    """‖Ĝ_k − G_k‖_F, (F,)."""
    return np.asarray(np.linalg.norm(data.matrices - d - resolvent(a, b, c, z), axis=(1, 2)))
