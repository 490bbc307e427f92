"""The frequency response of an experiment, to be looked at."""

from typing import Literal

from pydantic import Field

from app.arrays import ComplexVector
from app.schemas.common import CamelModel, Double, Integer
from app.schemas.experiments import Values

Method = Literal["periodicAverage", "localPolynomial", "given"]


class KramersKronigDocument(CamelModel):
    """What a chain of relaxations leaves of an impedance: the linear Kramers–Kronig test."""

    residual: ComplexVector = Field(description="(Z - fitted)/|Z| at the frequencies above zero")
    size: Double = Field(description="root mean square of the residual")
    conjugate_size: Double = Field(
        description="the same for the conjugate impedance; much smaller where the imaginary part has the wrong sign"
    )
    degrees_of_freedom: Integer
    p_value: Double | None = Field(description="null where the noise is not known well enough to judge")


class MeasuredResponseDocument(CamelModel):
    """Gain and phase as they were measured."""

    experiment_id: str
    method: Method = Field(
        description="how it was had from the record; given: it was brought in as a frequency response"
    )
    frequencies_rad_per_second: Values
    response: ComplexVector
    standard_deviation: Values | None = Field(description="root of the mean square error; null when not known")
    kramers_kronig: KramersKronigDocument | None = Field(
        description="of impedances, which have a current as input and a voltage as output; null for others"
    )
