"""Simulations of models: along p(t), or one period of the steady state at operating points held still."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from app.arrays import Matrix, Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.experiments import Channels, Identifier, LoggedQuantities, SchedulingRange, Values
from app.schemas.plants import LongText, OperatingPoint, SampleTime, Text
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


OperatingPoints = Annotated[list[OperatingPoint], Field(min_length=1, max_length=1000)]


class SteadyExcitation(CamelModel):
    """What every excitation of a steady state states."""

    logged_quantities: LoggedQuantities = Field(
        default_factory=list, description="values of the logged quantities that the model depends on, by name and unit"
    )


class PeriodicExcitation(SteadyExcitation):
    """One period of the input, repeated for ever at operating points that are held still, for models of any kind."""

    kind: Literal["periodic"]
    input: Annotated[Values, Field(min_length=2)] = Field(description="one period, sampled as a discrete-time model is")
    sample_time_seconds: SampleTime
    operating_points: OperatingPoints = Field(description="one value a scheduling variable each")


class PeriodicSignalExcitation(SteadyExcitation):
    """A signal of a design, repeated for ever."""

    kind: Literal["periodicSignal"]
    signals_id: Identifier
    index: Annotated[Integer, Field(ge=0, le=100_000)] = Field(default=0, description="which of the signals, from zero")
    operating_points: OperatingPoints | None = Field(default=None, description="null: the one it was designed for")


class PeriodicExperimentExcitation(SteadyExcitation):
    """What was played in a periodic record, at its operating point: the mean of its steady periods."""

    kind: Literal["periodicExperiment"]
    experiment_id: Identifier = Field(
        description="a time record of two periods or more; quantities logged with it need not be stated again"
    )


EXCITATIONS = (
    GivenExcitation,
    ExperimentExcitation,
    SignalExcitation,
    PeriodicExcitation,
    PeriodicSignalExcitation,
    PeriodicExperimentExcitation,
)

Steady = PeriodicExcitation | PeriodicSignalExcitation | PeriodicExperimentExcitation

if TYPE_CHECKING:
    Excitation = GivenExcitation | ExperimentExcitation | SignalExcitation | Steady
else:
    Excitation = named_union("Excitation", EXCITATIONS, "kind")


class SimulationRequest(CamelModel):
    """What to play to a model."""

    name: Text = ""
    description: LongText = ""
    excitation: Excitation = Field(
        description="input and scheduling from rest, or one period of the input in the steady state"
    )


class SimulatedOutput(CamelModel):
    """One output in short; of a steady state the output at one operating point."""

    operating_point: Vector | None = Field(default=None, description="null along p(t)")
    minimum: Double
    maximum: Double
    root_mean_square: Double
    deviation: Double | None = Field(
        description="root mean square of its standard deviation by the covariance of the model; null when not known"
    )


class LeftOutEffect(CamelModel):
    """An effect of the model that is not in a simulation."""

    kind: str
    title: str
    reason: str


class Simulation(CamelModel):
    """The output of a model along p(t) from rest, or one period of it in the steady state at operating points.

    Samples are found under `/data` and `/file`.
    """

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    description: LongText
    model_id: str
    kind: Literal["alongScheduling", "steadyPeriod"] = "alongScheduling"
    experiment_id: str | None = Field(description="the experiment that gave input and scheduling")
    signals_id: str | None = Field(description="the signals that gave the input")
    samples: Integer
    sample_time_seconds: Double
    ranges: list[SchedulingRange] = Field(description="of p(t) or the operating points, one a scheduling variable")
    outputs: list[SimulatedOutput] = Field(description="one an output; in the steady state one an operating point")
    left_out_effects: list[LeftOutEffect] = Field(
        default_factory=list, description="effects of single measurements, and disturbances that no input causes"
    )
    notes: list[str] = Field(description="what the simulation leaves out")


class SimulationList(CamelModel):
    """A page of simulations."""

    items: list[Simulation]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")


class SimulationData(CamelModel):
    """The samples of a simulation, one list a channel; in the steady state one output an operating point."""

    simulation_id: str
    sample_time_seconds: Double
    inputs: list[Values]
    scheduling: list[Values] = Field(description="empty for several operating points")
    outputs: list[Values]
    operating_points: Matrix | None = Field(default=None, description="of each output in the steady state; else null")
    lower95: list[Vector] | None = Field(description="ends of the 95 % band of each output; null when not known")
    upper95: list[Vector] | None
