"""Subspace identification from a frequency response on equidistant frequencies."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.signals import FrequencyResponse
from identification.subspace.domain import Domain
from identification.subspace.estimate import estimate
from identification.subspace.method import OrderRule
from identification.subspace.noise import Noise, Weighting
from identification.subspace.observability import ObservabilityRange
from identification.subspace.result import SubspaceEstimate
from identification.subspace.transition import Stability, Transition

FEWEST_BLOCKS = 64
SPACING_TOLERANCE = 1e-6


@dataclass(frozen=True)
class EquidistantSubspace:
    """A state-space model from a frequency response on equidistant frequencies from zero on (McKelvey 1).

        ĥ_i = 1/N Σ_k Ĝ_k e^{j2πik/N},   [ĥ_{i+j−1}] = U Σ Vᵀ (q block rows, r block columns),
        A = (J₁ U_s)^† J₂ U_s,   C = J₃ U_s,   B, D by least squares                    [Akcay2008, Algorithm 1]

    The lines lie at ω_k T = 2πk/N, k = 0 … N/2, up to the Nyquist frequency for even N and half a step below it for
    odd N, so that the N points with their conjugates fill the unit circle. In continuous time they lie at
    tan(πk/N) 2/T, N odd. Exact for noise-free responses with q > n, r ≥ n, q + r ≤ N [Akcay2008, Theorem 1], and
    consistent for noise of any bounded covariance [Akcay2008, Theorem 2]. The variances weight B and D only.
    """

    kind: ClassVar[str] = "equidistant_subspace"
    data: ClassVar[type] = FrequencyResponse

    order: Annotated[int | None, "number of states; none: chosen"] = None
    order_rule: Annotated[OrderRule, "error on held-out lines, or largest gap of the singular values"] = "held_out"
    max_order: Annotated[int | None, "highest order tried"] = None
    order_table: Annotated[bool, "judge all orders on held-out lines even when the order is stated"] = False
    block_rows: Annotated[int | None, "q, block rows of the Hankel matrix, more than the order"] = None
    block_columns: Annotated[int | None, "r, block columns of the Hankel matrix, at least the order"] = None
    weighting: Annotated[Weighting, "what the fit of B and D is weighted with"] = "automatic"
    transition: Annotated[Transition, "how A is found from the observability matrix"] = "least_squares"
    stability: Annotated[Stability, "how the model is kept stable"] = "none"
    zero_order_hold: Annotated[bool, "give the continuous-time system behind a zero-order hold"] = False

    @classmethod
    def example(cls) -> "EquidistantSubspace":
        """An instance for tests and catalogues."""
        return cls(order=2, block_rows=5, block_columns=5)

    def estimate(self, data: FrequencyResponse) -> SubspaceEstimate:
        """The model with its errors, and with the table of orders where it was needed or asked for.

        Raises RangeError for q ≤ n, r < n and frequencies that are not equidistant from zero on, NotIdentifiableError
        for too few lines or an order that the data do not show, and MisuseError for a weighting or a time domain that
        the data do not fit.
        """
        return estimate(self, data)

    def domain(self, data: FrequencyResponse) -> Domain:
        """The place of the lines on the unit circle; in continuous time from the first step, N being odd."""
        first = float(np.sort(data.frequencies)[min(1, len(data) - 1)])
        centre = (
            first / np.tan(np.pi / (2 * len(data) - 1)) if data.sample_time is None else np.pi / 2 / data.sample_time
        )
        return Domain.of(data, self.zero_order_hold, centre)

    def default_block_rows(self, order: int, data: FrequencyResponse) -> int:
        """Six times the order where there are lines enough: rows of impulse response that has not yet decayed."""
        return min(max(6 * order, FEWEST_BLOCKS), len(data) - 1)

    def most_orders(self, block_rows: int | None, data: FrequencyResponse) -> int:
        """The highest n with n < q and q + n ≤ 2M, and what the number of lines allows."""
        most = len(data) - 2
        most = most if block_rows is None else min(most, block_rows - 1, 2 * (len(data) - 1) - block_rows)
        return most if self.block_columns is None else min(most, self.block_columns)

    def require_sizes(self, order: int, block_rows: int, data: FrequencyResponse) -> None:
        """Raises where n, q, r and the number of lines do not fit [Akcay2008, Theorem 1]."""
        if self.block_columns is not None and self.block_columns < order:
            raise RangeError(
                f"{self.block_columns} block columns cannot show order {order}; take at least {order}", "block_columns"
            )
        least = block_rows + (self.block_columns or order)
        if 2 * len(data) - 1 < least:
            raise NotIdentifiableError(
                f"{len(data)} lines are too few for order {order} with {block_rows} block rows and"
                f" {self.block_columns or order} block columns; measure at least {-(-(least + 1) // 2)} lines",
                "frequencies",
            )

    def observability(
        self, z: ComplexArray, data: FrequencyResponse, noise: Noise, block_rows: int, order: int
    ) -> ObservabilityRange:
        """The range of the observability matrix from the Hankel matrix of impulse response coefficients."""
        count = circle_points(z)
        if block_rows + (self.block_columns or order) > count:
            raise NotIdentifiableError(
                f"{block_rows} block rows and {self.block_columns or order} block columns need more than these"
                f" {len(data)} lines; take fewer or measure more lines",
                "frequencies",
            )
        columns = min(block_rows, count - block_rows) if self.block_columns is None else self.block_columns
        matrix = _hankel(np.fft.irfft(data.matrices, count, axis=0), block_rows, columns)
        left, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
        found = min(order, int(np.sum(sizes > 0)))
        vectors = left[:, :found].reshape(block_rows, data.output_count, found).transpose(1, 0, 2)
        return ObservabilityRange(vectors, sizes, np.eye(block_rows, k=-1))


def circle_points(z: ComplexArray) -> int:
    """N of lines z_k = e^{j2πk/N}, k = 0 … N/2, with their conjugates; raises RangeError for other lines."""
    angle, count = np.angle(z) % (2 * np.pi), len(z)
    for points in (2 * count - 2, 2 * count - 1):
        if points > 0 and np.allclose(
            angle, 2 * np.pi * np.arange(count) / points, rtol=0, atol=SPACING_TOLERANCE / points
        ):
            return points
    if count > 1 and angle[0] == 0:
        raise RangeError(
            "the frequencies are not equidistant up to the Nyquist frequency; use the frequency subspace method for"
            " arbitrary frequencies",
            "frequencies",
        )
    raise MisuseError(
        "the frequencies do not begin at zero; use the frequency subspace method for arbitrary frequencies",
        "frequencies",
    )


def _hankel(impulse: FloatArray, rows: int, columns: int) -> FloatArray:
    """[ĥ_{i+j−1}] (q n_y, r n_u) of ĥ (N, n_y, n_u)."""
    blocks = impulse[1 + np.arange(rows)[:, None] + np.arange(columns)]
    return np.asarray(blocks.transpose(0, 2, 1, 3).reshape(rows * impulse.shape[1], columns * impulse.shape[2]))
