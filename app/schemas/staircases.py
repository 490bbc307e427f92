"""Staircases: effects added to a model one after the other until noise explains what is left."""

from typing import Annotated

from pydantic import Field, model_validator

from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.comparisons import ExperimentIds
from app.schemas.diagnoses import AmplitudeDegree, Domain, Kind, Seed, Verdict
from app.schemas.experiments import Identifier
from app.schemas.outcomes import TestDocument
from app.schemas.plants import LongText, Text


class StaircaseRequest(CamelModel):
    """What to fit and judge by, and where to stop."""

    experiment_ids: ExperimentIds = Field(description="all versions are fitted to these")
    held_out_experiment_ids: Annotated[list[Identifier], Field(max_length=1000)] = Field(
        default_factory=list, description="experiments that no version was fitted to; their error must not rise"
    )
    effects: Annotated[list[Kind], Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="kinds of effects to judge, as in the catalogue; null for the whole library"
    )
    domain: Domain | None = Field(
        default=None, description="judge the effects of this kind of plant and the general ones; null for all"
    )
    largest: Annotated[Integer, Field(ge=1, le=8)] = Field(default=4, description="most effects to add")
    amplitude_degree: AmplitudeDegree = Field(default=0, description="of the amplitudes in each scheduling variable")
    mean_value: bool = Field(default=True, description="use the mean value of periodic records too")
    seed: Seed = Field(default=0, description="of the draws that p-values of the whole family come from")
    name: Text = ""
    description: LongText = ""

    @model_validator(mode="after")
    def _one_choice(self) -> "StaircaseRequest":
        if self.effects is not None and self.domain is not None:
            raise ValueError("give effects or domain, not both")
        return self


class StaircaseStep(CamelModel):
    """A version of the model, its errors, and the diagnosis of what it lacks."""

    model_id: str
    diagnosis_id: str
    added: str | None = Field(description="kind of the effect that is new in this version; null in the first")
    fitted: Double = Field(description="relative error ‖Y − Ŷ‖/‖Y‖ at the excited lines")
    held_out: Double | None = Field(description="null when no experiment was held out")
    lack_of_fit: TestDocument = Field(description="on the fitted experiments")


class Staircase(CamelModel):
    """Versions of a model from its beginning to the noise floor; each is a model, each diagnosis a diagnosis."""

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    description: LongText
    model_id: str = Field(description="the model that it began with")
    experiment_ids: list[str]
    held_out_experiment_ids: list[str]
    seed: Integer
    conclusion: Verdict
    steps: list[StaircaseStep]


class StaircaseList(CamelModel):
    """A page of staircases."""

    items: list[Staircase]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")
