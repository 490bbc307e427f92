"""How computations ended, and what their results are held against."""

from typing import Literal

from pydantic import Field

from app.arrays import ComplexVector, Vector
from app.schemas.common import CamelModel, Double, Integer


class OutcomeDocument(CamelModel):
    """How a computation ended."""

    status: Literal["converged", "not_converged", "not_identifiable", "infeasible"]
    advice: str = Field(description="what to change when it did not converge")
    iterations: Integer


class TestDocument(CamelModel):
    """A statistic held against its distribution; a small p-value speaks against the model."""

    __test__ = False

    name: str
    statistic: Double | None
    degrees_of_freedom: Double | None
    p_value: Double | None


class PolesAtPoint(CamelModel):
    """Poles at one operating point."""

    operating_point: Vector
    poles: ComplexVector = Field(description="in the z-plane, or in rad/s in continuous time")
