"""Outcome as data: how a computation ended, with advice where it did not reach its aim."""

from dataclasses import dataclass
from typing import Literal

Status = Literal["converged", "not_converged", "not_identifiable", "infeasible"]


@dataclass(frozen=True)
class Outcome:
    """How a computation ended; `advice` says what to change when `status` is not "converged"."""

    status: Status
    advice: str = ""
    iterations: int = 0

    @property
    def ok(self) -> bool:
        """True when the result can be used as it is."""
        return self.status == "converged"


@dataclass(frozen=True)
class TestResult:
    """A statistic held against its distribution under the null hypothesis; small `p_value` speaks against it."""

    __test__ = False

    name: str
    statistic: float
    degrees_of_freedom: float
    p_value: float
