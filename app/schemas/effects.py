"""Physical effects: in models, in evidence."""

from pydantic import Field

from app.arrays import Matrix
from app.schemas.common import CamelModel, Double, Integer


class EffectParameter(CamelModel):
    """A parameter of an effect besides its amplitude."""

    name: str
    value: Double
    standard_deviation: Double | None = Field(description="null when it was chosen, not fitted, or is not determined")
    fitted: bool


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
