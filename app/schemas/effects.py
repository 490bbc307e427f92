"""Physical effects: in models, in evidence."""

from typing import Literal

from pydantic import Field

from app.arrays import Matrix, Vector
from app.schemas.common import CamelModel, Double, Integer


class EffectParameter(CamelModel):
    """A parameter of an effect besides its amplitude."""

    name: str
    value: Double
    standard_deviation: Double | None = Field(description="null when it was chosen, not fitted, or is not determined")
    fitted: bool


class CurveDocument(CamelModel):
    """A static curve without a name, drawn where the data are: what it adds beyond a straight line."""

    over: Literal["displacement", "flow", "input", "output", "scheduling"]
    knots: Vector = Field(description="of the splines, in ascending order; over the scaled p for scheduling")
    argument_label: str
    argument_unit: str
    value_unit: str
    argument: Vector
    value: Vector = Field(description="with the amplitudes amid the range of the scheduling variables")
    standard_deviation: Vector | None = Field(
        description="at each argument; null when the data leave the amplitudes open"
    )


class PlacedEffectDocument(CamelModel):
    """A physical effect with its amplitude e(p): 1, then powers of each scheduling variable, scaled to −1 … 1."""

    kind: str = Field(description="as in the catalogue")
    title: str
    place: str = Field(description="where it acts")
    unit: str = Field(description="unit of the amplitude")
    quantity: str | None = Field(default=None, description="logged quantity, with its unit, that it depends on")
    amplitude_degree: Integer = Field(description="degree of e in each scheduling variable")
    coefficients: Matrix = Field(description="of e, one row for each amplitude of the effect")
    standard_deviations: Matrix | None = Field(description="of the coefficients; null when the data leave them open")
    parameters: list[EffectParameter]
    curve: CurveDocument | None = Field(default=None, description="where the effect is a curve without a name")
