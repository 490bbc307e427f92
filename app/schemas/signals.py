"""Signals: designs made into what is played."""

from typing import Annotated, Literal

from pydantic import Field

from app.arrays import Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.plants import LongText, Positive, Text


class SignalsRequest(CamelModel):
    """How a design is to be played."""

    name: Text = ""
    description: LongText = ""
    method: Literal["multisine", "filtered_noise"] = Field(
        default="multisine", description="exactly the designed lines, or noise with the designed spectrum"
    )
    samples: Annotated[Integer, Field(ge=2, le=10_000_000)] | None = Field(
        default=None,
        description="samples of one period; null: the period of designed lines, else those of the design by `periods`",
    )
    periods: Annotated[Integer, Field(ge=1, le=10_000)] | None = Field(
        default=None, description="periods that share the energy; null: as many as the duration of the design holds"
    )
    amplitude_limit: Positive | None = Field(default=None, description="largest value; null: none")
    oversampling: Annotated[Integer, Field(ge=1, le=16)] = Field(
        default=1,
        description="above 1, crest factor and limit are those behind a reconstruction filter; multisines only",
    )
    seed: Annotated[Integer, Field(ge=0, le=2**53)] = Field(default=0, description="of the phases or the noise")


class SignalDocument(CamelModel):
    """The signal of one operating point."""

    index: Integer = Field(description="its number, for the file")
    operating_point: Vector
    sample_time_seconds: Double
    period_samples: Integer
    periods: Integer
    samples: Integer = Field(description="of all periods together")
    duration_seconds: Double
    energy: Double = Field(description="Σ u(t)² over all samples")
    peak: Double
    crest_factor: Double
    crest_factor_between_samples: Double = Field(description="of the signal behind a reconstruction filter")
    amplitude_limit: Double | None
    amplitude_limit_binds: bool
    needed_samples: Integer | None = Field(description="samples that the amplitude limit asks for, when it binds")
    frequencies_rad_per_second: Vector = Field(description="of the lines asked for")
    requested_energies: Vector = Field(description="of these lines")
    achieved_energies: Vector = Field(description="of these lines, in the signal as it is")
    energy_elsewhere: Double = Field(description="on lines that were not asked for")


class Signals(CamelModel):
    """The signals of a design, one an operating point; samples are found under `/file`."""

    id: str
    created_at: Timestamp
    software_version: str
    job_id: str | None
    plant_id: str
    model_id: str
    design_id: str
    request: SignalsRequest
    seed: Integer
    signals: list[SignalDocument]


class SignalsList(CamelModel):
    """A page of signals."""

    items: list[Signals]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")
