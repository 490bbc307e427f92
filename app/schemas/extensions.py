"""Extensions of models by physical effects."""

from typing import Annotated

from pydantic import Field

from app.schemas.common import CamelModel
from app.schemas.comparisons import ExperimentIds
from app.schemas.diagnoses import AmplitudeDegree, Kind, Seed
from app.schemas.experiments import Identifier
from app.schemas.plants import LongText, Name, Text


class ExtensionRequest(CamelModel):
    """Which effect to add to a model, and which experiments to fit both to."""

    effect: Kind = Field(description="its kind, as in the catalogue")
    quantity: Name | None = Field(
        default=None, description="which logged quantity second_variable is; needed where several were logged"
    )
    amplitude_degree: AmplitudeDegree = Field(default=0, description="of the amplitude in each scheduling variable")
    experiment_ids: ExperimentIds = Field(description="the parameters of model and effect are fitted to these together")
    held_out_experiment_ids: Annotated[list[Identifier], Field(max_length=1000)] = Field(
        default_factory=list, description="experiments that no version was fitted to, for the error before and after"
    )
    diagnosis_id: Identifier | None = Field(default=None, description="the diagnosis that pointed to the effect")
    mean_value: bool = Field(default=True, description="fit the mean value of periodic records too")
    seed: Seed = Field(default=0, description="of the draws of the score test that the fit starts from")
    name: Text = ""
    description: LongText = ""
