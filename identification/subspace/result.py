"""What the subspace estimators return."""

from dataclasses import dataclass

from identification.arrays import FloatArray
from identification.models.system import StateSpace
from identification.outcome import Outcome
from identification.signals import OperatingPoint


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
