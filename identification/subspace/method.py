"""What the shared steps of the subspace estimators need to know of each, and the sizes that follow."""

from typing import Literal, Protocol

from identification.arrays import ComplexArray
from identification.errors import RangeError
from identification.signals import FrequencyResponse
from identification.subspace.domain import Domain
from identification.subspace.noise import Noise, Weighting
from identification.subspace.observability import ObservabilityRange
from identification.subspace.transition import Stability, Transition

OrderRule = Literal["held_out", "singular_values"]

MOST_ORDERS = 20


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


def require_positive(method: Method) -> None:
    """Raises RangeError for an order, a highest order or block rows below one."""
    for name in ("order", "max_order", "block_rows"):
        value = getattr(method, name)
        if value is not None and value < 1:
            raise RangeError(f"{name} is {value}; it must be one or more", name)


def highest_order(method: Method, data: FrequencyResponse) -> int:
    """The highest order to try."""
    if method.max_order is not None:
        return method.max_order
    return min(max(MOST_ORDERS, method.order or 0), method.most_orders(method.block_rows, data))


def block_rows_of(method: Method, order: int, data: FrequencyResponse) -> int:
    """q for an order; raises where it does not fit the order or the lines."""
    rows = method.default_block_rows(order, data) if method.block_rows is None else method.block_rows
    if method.block_rows is not None and rows <= order:
        raise RangeError(
            f"{rows} block rows cannot show order {order}; take at least {order + 1}, or a lower order", "block_rows"
        )
    method.require_sizes(order, max(rows, order + 1), data)
    return max(rows, order + 1)
