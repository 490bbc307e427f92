"""Basis functions, to be looked at before a plant is described with them."""

from typing import Annotated

from pydantic import Field

from app.arrays import Matrix, Vector
from app.schemas.common import CamelModel, Integer
from app.schemas.plants import ProductBasisDocument, SchedulingVariableDocument


class BasisValuesRequest(CamelModel):
    """Which basis to look at, over which range."""

    scheduling_variables: Annotated[list[SchedulingVariableDocument], Field(min_length=1, max_length=10)]
    basis: ProductBasisDocument
    count: Annotated[Integer, Field(ge=2, le=1001)] = Field(
        default=101, description="values of each variable; fewer where all combinations would be more than 2500"
    )


class BasisFunctionValues(CamelModel):
    """One function of a basis."""

    label: str = Field(description="its index in each factor, as in the names of parameters")
    values: Vector = Field(description="one an operating point")


class BasisValues(CamelModel):
    """The functions of a basis over the whole range."""

    axes: Matrix = Field(description="the values of each variable")
    operating_points: Matrix = Field(description="all combinations of them, the last variable first")
    functions: list[BasisFunctionValues]
