"""Subspace identification from a frequency response at arbitrary frequencies."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import ComplexArray
from identification.errors import NotIdentifiableError
from identification.signals import FrequencyResponse
from identification.subspace.domain import Domain
from identification.subspace.estimate import estimate
from identification.subspace.method import OrderRule
from identification.subspace.noise import Noise, Weighting
from identification.subspace.observability import ObservabilityRange, observability_range
from identification.subspace.result import SubspaceEstimate
from identification.subspace.transition import Stability, Transition


@dataclass(frozen=True)
class FrequencySubspace:
    """A state-space model from a frequency response at arbitrary distinct frequencies (McKelvey 2).

        K⁻¹ 𝒢 𝒲^⊥ = U Σ Vᵀ,   O = K U_s,   A = (J₁ O)^† J₂ O,   C = J₃ O,   B, D by least squares

    [Akcay2008, Algorithm 2], for several inputs and outputs, in discrete time and by the bilinear map in continuous
    time. Noise-free responses of order n are reproduced exactly from n + q lines, q > n [Akcay2008, Theorem 3]; with
    K from the variances of the lines the estimate is consistent [Akcay2008, Theorem 4].

    `weighting` "variance" makes K from the stated variances or covariances, "equal" from equal ones, "none" takes
    K = I with the powers z^i; the default takes the variances where there are any and equal ones otherwise. K = I and
    equal variances are the same for equidistant lines around the circle, and only then is K = I consistent.
    """

    kind: ClassVar[str] = "frequency_subspace"
    data: ClassVar[type] = FrequencyResponse

    order: Annotated[int | None, "number of states; none: chosen"] = None
    order_rule: Annotated[OrderRule, "error on held-out lines, or largest gap of the singular values"] = "held_out"
    max_order: Annotated[int | None, "highest order tried"] = None
    order_table: Annotated[bool, "judge all orders on held-out lines even when the order is stated"] = False
    block_rows: Annotated[int | None, "q, block rows of the observability matrix, more than the order"] = None
    weighting: Annotated[Weighting, "what K and the fit of B and D are made from"] = "automatic"
    transition: Annotated[Transition, "how A is found from the observability matrix"] = "least_squares"
    stability: Annotated[Stability, "how the model is kept stable"] = "none"
    zero_order_hold: Annotated[bool, "give the continuous-time system behind a zero-order hold"] = False
    centre: Annotated[float | None, "frequency placed a quarter turn round the unit circle, rad/s; none: median"] = None

    @classmethod
    def example(cls) -> "FrequencySubspace":
        """An instance for tests and catalogues."""
        return cls(order=2, block_rows=5)

    def estimate(self, data: FrequencyResponse) -> SubspaceEstimate:
        """The model with its errors, and with the table of orders where it was needed or asked for.

        Raises RangeError for q ≤ n, NotIdentifiableError for fewer than n + q lines or an order that the data do not
        show, and MisuseError for a weighting or a time domain that the data do not fit.
        """
        return estimate(self, data)

    def domain(self, data: FrequencyResponse) -> Domain:
        """The place of the lines on the unit circle; where powers of z weight them, z is e^{jωT} itself."""
        centre = self.centre
        if self.weighting == "none" and centre is None and data.sample_time is not None:
            centre = np.pi / 2 / data.sample_time
        return Domain.of(data, self.zero_order_hold, centre)

    def default_block_rows(self, order: int, data: FrequencyResponse) -> int:
        """More than the order, the more the fewer outputs there are, as far as the lines reach."""
        wanted = order + 1 + -(-max(order, 8) // data.output_count)
        return max(min(wanted, len(data) - order), order + 1)

    def most_orders(self, block_rows: int | None, data: FrequencyResponse) -> int:
        """The highest n with n < q and n + q lines."""
        return (len(data) - 1) // 2 if block_rows is None else min(block_rows - 1, len(data) - block_rows)

    def require_sizes(self, order: int, block_rows: int, data: FrequencyResponse) -> None:
        """Raises NotIdentifiableError for fewer than n + q lines [Akcay2008, Theorem 3]."""
        if len(data) < order + block_rows:
            raise NotIdentifiableError(
                f"{len(data)} lines are too few for order {order} with {block_rows} block rows; measure at least"
                f" {order + block_rows} lines or take fewer block rows",
                "frequencies",
            )

    def observability(
        self, z: ComplexArray, data: FrequencyResponse, noise: Noise, block_rows: int, order: int
    ) -> ObservabilityRange:
        """The range of the observability matrix."""
        return observability_range(z, data.matrices, noise, block_rows, order, self.weighting == "none")
