"""Diagnoses: which physical effect a model lacks."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from app.arrays import ComplexVector, Matrix, Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.comparisons import ExperimentIds, NoteDocument
from app.schemas.designs import DesignRequest
from app.schemas.effects import EffectParameter, PlacedEffectDocument
from app.schemas.experiments import Identifier
from app.schemas.outcomes import OutcomeDocument, TestDocument
from app.schemas.plants import LongText, Text
from app.schemas.quantities import QuantityName
from identification.diagnosis.remainder import MATERIAL

Kind = Annotated[str, Field(min_length=1, max_length=64)]
Verdict = Literal["nothingMissing", "explained", "partlyExplained", "notInTheLibrary", "cannotBeJudged"]
Domain = Literal["general", "mechanical", "electrical", "impedance"]
AmplitudeDegree = Annotated[Integer, Field(ge=0, le=3)]
Seed = Annotated[Integer, Field(ge=0)]


class DiagnosisRequest(CamelModel):
    """What to judge by: a comparison, or a model and experiments."""

    comparison_id: Identifier | None = Field(
        default=None, description="its model and those of its experiments that were fitted, or all if none was"
    )
    model_id: Identifier | None = Field(default=None, description="in place of a comparison")
    experiment_ids: ExperimentIds | None = Field(
        default=None,
        description="experiments to judge by; needed with modelId, else in place of those of the comparison",
    )
    effects: Annotated[list[Kind], Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="kinds of effects to judge, as in the catalogue; null for the whole library"
    )
    domain: Domain | None = Field(
        default=None, description="judge the effects of this kind of plant and the general ones; null for all"
    )
    amplitude_degree: AmplitudeDegree = Field(default=0, description="of the amplitudes in each scheduling variable")
    mean_value: bool = Field(default=True, description="judge by the mean value of periodic records too")
    material: Annotated[Double, Field(ge=0, lt=1)] = Field(
        default=MATERIAL,
        description="what is missing is announced where it is more than this share of the output, beyond noise",
    )
    seed: Seed = Field(default=0, description="of the draws that p-values of the whole family come from")
    name: Text = ""
    description: LongText = ""

    @model_validator(mode="after")
    def _one_source(self) -> "DiagnosisRequest":
        if (self.comparison_id is None) == (self.model_id is None):
            raise ValueError("give either comparisonId or modelId")
        if self.model_id is not None and self.experiment_ids is None:
            raise ValueError("give experimentIds with modelId")
        if self.effects is not None and self.domain is not None:
            raise ValueError("give effects or domain, not both")
        return self


class Evidence(CamelModel):
    """An effect after its refit together with the parameters of the model."""

    effect: PlacedEffectDocument = Field(description="as fitted, amplitude in its unit with standard deviations")
    bic: Double = Field(description="−2 ln L + parameters · ln(numbers compared); low is good")
    weight: Double = Field(
        description="share of exp(−BIC/2) among the refitted effects and none of these, times `share`; what an effect"
        " leaves belongs to none of these"
    )
    share: Double = Field(default=1.0, description="of what noise does not explain, what this effect takes away")
    at_bound: bool = Field(
        default=False,
        description="held by an end of its physical range: no estimate, and no interval",
    )
    chi_square_explained: Double = Field(description="fall of minus twice the log-likelihood")
    added_parameters: Integer
    chi_square_per_parameter: Double
    outcome: OutcomeDocument


class RankedEffect(CamelModel):
    """What speaks for one effect; by BIC where it was refitted, then by adjusted p."""

    kind: str
    title: str
    place: str
    unit: str
    quantity: str | None = Field(default=None, description="logged quantity, with its unit, that it depends on")
    reading: str = Field(
        default="", description="what the force is by what the output is, where the plant does not state its quantity"
    )
    announced: bool = Field(description="one of those that cannot be told apart and may be what is missing")
    parameters: list[EffectParameter] = Field(description="of the variant with the best score")
    score: Double = Field(description="Rao score S; negative where the amplitude would have the wrong sign")
    p_value: Double = Field(description="of the effect with all its variants")
    adjusted_p_value: Double = Field(description="for all effects that were judged: below 0.05 something is missing")
    evidence: Evidence | None = Field(description="null when it was not on the short list or not of this shape")


class EffectVisibility(CamelModel):
    """Whether these experiments could show an effect."""

    kind: str
    title: str
    quantity: str | None = Field(default=None, description="logged quantity, with its unit, that it depends on")
    status: Literal["visible", "invisible", "notJudged"] = Field(
        description="invisible: the fitted parameters take up all of it; notJudged: the data are not of the kind"
        " needed, or the model holds it, or another curve of fitted shape in its place, already"
    )
    detectable_amplitude: Double | None = Field(description="found with 90 % power by a test at 5 %; null if never")
    kept: Double = Field(description="share of its change of the output that the fitted parameters leave")
    reason: str


class ExplainedResponse(CamelModel):
    """What one effect explains of a missing response."""

    kind: str
    response: ComplexVector = Field(description="at the frequencies of the missing response")


class MissingResponse(CamelModel):
    """The smooth picture of what the model lacks: the response at one experiment."""

    experiment_id: str
    operating_point: Vector
    frequencies_rad_per_second: Vector
    response: ComplexVector = Field(description="kernel estimate of (Y − Ŷ)/U")
    standard_deviation: Vector = Field(description="of its absolute value where only noise is left")
    explained: list[ExplainedResponse] = Field(
        default_factory=list, description="what the first of the refitted effects take up of it, smoothed alike"
    )


class VariationDocument(CamelModel):
    """An effect that changes the variance and not the mean."""

    kind: str
    title: str
    unit: str
    size: Double = Field(description="its standard deviation, by restricted likelihood")
    p_value: Double = Field(description="of its score test, for all variants")
    explains: bool = Field(description="whether it explains all that is missing, better than every effect on the mean")
    advice: str


class Diagnosis(CamelModel):
    """Which missing effect the measurements point to."""

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    description: LongText
    model_id: str
    comparison_id: str | None
    experiment_ids: list[str]
    input_quantity: QuantityName | None = Field(default=None, description="what the input was taken for, as stated")
    output_quantity: QuantityName | None = Field(
        default=None, description="what the output was taken for; not stated: position, speed and acceleration"
    )
    amplitude_degree: Integer
    mean_value: bool
    seed: Integer
    verdict: Verdict = Field(
        description="explained: noise explains what the best effect leaves, or it is below what is material;"
        " partlyExplained: more is left, or the effect was held by an end of its range; notInTheLibrary: something is"
        " missing and no effect is better than none of these; cannotBeJudged: `reason` says why"
    )
    reason: str = Field(default="", description="for the verdict, with the numbers that it stands on")
    rest_before: Double | None = Field(
        default=None, description="what the model leaves beyond noise, relative to the output at the excited lines"
    )
    rest_after: Double | None = Field(default=None, description="the same with the best announced effect")
    material: Double | None = Field(default=None, description="the rest below which nothing is called missing")
    none_of_these_weight: Double | None = Field(default=None, description="the weight that the effects leave")
    variations: list[VariationDocument] = Field(
        default_factory=list, description="what differs from record to record or within records"
    )
    notes: list[NoteDocument] = Field(default_factory=list, description="what to mind of single experiments")
    confident: bool = Field(description="one effect has over 95 % of the weight of all and explains what is missing")
    announced: list[str] = Field(description="kinds that cannot be told apart here, best first; empty when none")
    lack_of_fit: TestDocument = Field(description="of the model, its parameters fitted to these experiments")
    remaining: TestDocument = Field(description="lack of fit with the best announced effect")
    explained_share: Double = Field(description="of what noise does not explain, what the best effect takes away")
    ranking: list[RankedEffect]
    confusability: Matrix = Field(
        description="squared cosine between the signatures, in the order of `ranking`; 1: cannot be told apart here"
    )
    deciding_design: DesignRequest | None = Field(
        default=None,
        description="ready to post: the experiments that tell the announced effects apart; null where there is one"
        " effect or none, or where no signals were played that tell levels and period",
    )
    visibility: list[EffectVisibility] = Field(description="of every effect that was to be judged")
    missing: list[MissingResponse]


class DiagnosisList(CamelModel):
    """A page of diagnoses."""

    items: list[Diagnosis]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")
