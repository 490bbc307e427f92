"""Examples: simulated plants with measurements, to learn and to try things with."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.experiments import Identifier
from app.schemas.plants import Text
from app.virtual_plant.hidden import EFFECTS

Seed = Annotated[Integer, Field(ge=0)]
if TYPE_CHECKING:
    Choice = str
else:
    Choice = Literal[("random", "none", *EFFECTS)]


class ExampleRequest(CamelModel):
    """Which example to make: a simulated plant, measured, that does something its model structure does not know."""

    hidden_effect: Choice = Field(default="random", description="what the plant hides; random: the seed decides")
    seed: Seed = Field(default=0, description="of the input signals and the noise")
    name: Text = Field(default="", description="of the plant; empty: chosen")


class HiddenEffectDocument(CamelModel):
    """What an example hides: spoils the game when it is shown before the diagnosis."""

    kind: str = Field(description="as in the catalogue")
    amplitude: Double
    unit: str = Field(description="unit of the amplitude")


class Example(CamelModel):
    """A simulated plant with experiments, some of them meant to be held out."""

    id: str
    created_at: Timestamp
    software_version: str
    job_id: str | None
    plant_id: str
    experiment_ids: list[str] = Field(description="to identify a model from")
    held_out_experiment_ids: list[str] = Field(description="at other operating points, to judge a model by")
    noise_standard_deviation: Double = Field(description="of the output, in its unit")
    seed: Integer
    hidden: HiddenEffectDocument | None = Field(description="what a diagnosis should find; null: nothing is hidden")


class MeasurementRequest(CamelModel):
    """Which signals to play on the simulated plant."""

    signals_id: Identifier = Field(description="signals of a design for this plant")
    seed: Seed = Field(default=0, description="of the noise")


class SimulatedMeasurement(CamelModel):
    """Designed signals played on the simulated plant, one experiment each."""

    id: str
    created_at: Timestamp
    software_version: str
    job_id: str | None
    plant_id: str
    example_id: str
    signals_id: str
    design_id: str
    experiment_ids: list[str]
    seed: Integer


class ExampleList(CamelModel):
    """A page of examples."""

    items: list[Example]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")
