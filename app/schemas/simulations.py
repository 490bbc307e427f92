"""Simulations of models along p(t)."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from app.arrays import Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.experiments import Channels, Identifier, SchedulingRange, Values
from app.schemas.plants import LongText, Text
from app.schemas.plug_ins import named_union


class GivenExcitation(CamelModel):
    """Input and scheduling as stated, sampled as the model is."""

    kind: Literal["given"]
    inputs: Channels = Field(description="one list of samples for each input")
    scheduling: Channels = Field(description="one list of samples for each scheduling variable, in its range")


class ExperimentExcitation(CamelModel):
    """What was played in an experiment of the same plant."""

    kind: Literal["experiment"]
    experiment_id: Identifier = Field(description="a time record, or a record along varying scheduling")


class SignalExcitation(CamelModel):
    """A signal of a design at its operating point: a dry run."""

    kind: Literal["signal"]
    signals_id: Identifier
    index: Annotated[Integer, Field(ge=0, le=100_000)] = Field(default=0, description="which of the signals, from zero")


EXCITATIONS = (GivenExcitation, ExperimentExcitation, SignalExcitation)

if TYPE_CHECKING:
    Excitation = GivenExcitation | ExperimentExcitation | SignalExcitation
else:
    Excitation = named_union("Excitation", EXCITATIONS, "kind")


class SimulationRequest(CamelModel):
    """What to play to a model."""

    name: Text = ""
    description: LongText = ""
    excitation: Excitation = Field(description="input and scheduling, from rest")


class SimulatedOutput(CamelModel):
    """One output in short."""

    minimum: Double
    maximum: Double
    root_mean_square: Double
    deviation: Double | None = Field(
        description="root mean square of its standard deviation by the covariance of the model; null when not known"
    )


class Simulation(CamelModel):
    """The output of a model along p(t), from rest; samples are found under `/data` and `/file`."""

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    description: LongText
    model_id: str
    experiment_id: str | None = Field(description="the experiment that gave input and scheduling")
    signals_id: str | None = Field(description="the signals that gave the input")
    samples: Integer
    sample_time_seconds: Double
    ranges: list[SchedulingRange] = Field(description="of p(t), one a scheduling variable")
    outputs: list[SimulatedOutput]
    notes: list[str] = Field(description="what the simulation leaves out")


class SimulationList(CamelModel):
    """A page of simulations."""

    items: list[Simulation]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")


class SimulationData(CamelModel):
    """The samples of a simulation, one list a channel."""

    simulation_id: str
    sample_time_seconds: Double
    inputs: list[Values]
    scheduling: list[Values]
    outputs: list[Values]
    lower95: list[Vector] | None = Field(description="ends of the 95 % band of each output; null when not known")
    upper95: list[Vector] | None
