"""Models: identified from experiments, or stated."""

from typing import Annotated, Literal

from pydantic import Field

from app.arrays import ComplexVector, Matrix, Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.effects import PlacedEffectDocument
from app.schemas.experiments import Identifier
from app.schemas.families import LocalEstimator, LpvEstimator, SpectralEstimator
from app.schemas.outcomes import OutcomeDocument, PolesAtPoint, TestDocument
from app.schemas.plants import (
    CoefficientBasis,
    LongText,
    Positive,
    ProductBasisDocument,
    RationalStructureDocument,
    Structure,
    Text,
)
from app.schemas.requests import KindRequest
from app.schemas.state_space import StateSpaceResult
from app.schemas.varying import VaryingResult


class ModelRequest(KindRequest):
    """Which experiments to identify a rational model, also in physical form, from, and how."""

    kind: Literal["rational"]
    plant_id: Identifier
    name: Text = ""
    description: LongText = ""
    experiment_ids: Annotated[list[Identifier], Field(min_length=1, max_length=1000)] = Field(
        description="experiments of this plant; several may share an operating point"
    )
    local_estimator: LocalEstimator = Field(description="how the model of one operating point is found")
    lpv_estimator: LpvEstimator = Field(description="how the parameter-varying model is found")
    spectral_estimator: SpectralEstimator | None = Field(
        default=None,
        description="how time records become frequency responses, when the local estimator needs those",
    )
    structure: RationalStructureDocument | None = Field(
        default=None, description="in place of the structure of the plant"
    )
    basis: ProductBasisDocument | None = Field(default=None, description="in place of the basis of the plant")
    coefficient_bases: list[CoefficientBasis] | None = Field(default=None, description="in place of those of the plant")
    prior_model_id: Identifier | None = Field(
        default=None,
        description="a model from other experiments, whose information is added; the new model is its next version",
    )


class StatedModelRequest(CamelModel):
    """A model whose parameters are stated, from physics or from earlier work."""

    plant_id: Identifier
    name: Text = ""
    description: LongText = ""
    theta: Vector = Field(description="parameters, in the order of the plant's parameterNames")
    noise_variance: Positive = Field(description="variance of the white noise e")
    covariance: Matrix | None = Field(default=None, description="covariance of theta; null when it is not known")


class LocalModelDocument(CamelModel):
    """The model of one operating point."""

    operating_point: Vector
    zeta: Vector = Field(description="coefficients, in the order of coefficientNames")
    standard_deviations: Vector | None = Field(description="of zeta; null when the data do not determine them")
    covariance: Matrix | None
    noise_variance: Double | None
    outcome: OutcomeDocument
    tests: list[TestDocument]
    fit_percent: Double | None = Field(description="100 (1 − ‖y − ŷ‖/‖y − mean(y)‖)")
    relative_error: Double | None = Field(
        description="root mean square of |Ĝ − G|/|Ĝ| over the frequencies; null for time records"
    )
    stable: bool
    experiment_id: str | None = Field(description="the experiment that it was fitted to")


class ErrorsDocument(CamelModel):
    """Relative errors ‖Y − Ŷ‖/‖Y‖ at the excited lines."""

    fitted: Double
    held_out: Double | None = Field(description="null when no experiment was held out")
    lack_of_fit: TestDocument = Field(description="on the fitted experiments")


class ExtensionReport(CamelModel):
    """What an effect brought: errors of the model without it and with it, fitted to the same experiments."""

    diagnosis_id: str | None = Field(description="the diagnosis that pointed to the effect")
    held_out_experiment_ids: list[str]
    before: ErrorsDocument = Field(description="the parent, its parameters fitted once more to these experiments")
    after: ErrorsDocument


class Model(CamelModel):
    """A parameter-varying model with its accuracy and where it came from."""

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    description: LongText
    origin: Literal["identified", "stated", "extended"]
    structure: Structure
    basis: ProductBasisDocument
    coefficient_bases: list[CoefficientBasis]
    coefficient_names: list[str]
    parameter_names: list[str]
    theta: Vector = Field(
        description="of a state-space model all entries of A, B, C and D, function by function, row by row"
    )
    standard_deviations: Vector | None = Field(description="of theta; null when they are not known")
    covariance: Matrix | None = Field(description="of theta; null when it is not known")
    noise_variance: Double | None = Field(description="null for a state-space model that was not refined")
    outcome: OutcomeDocument
    tests: list[TestDocument]
    local_models: list[LocalModelDocument]
    stable: bool = Field(description="at every operating point of a grid over the range")
    poles: list[PolesAtPoint] = Field(description="over the range, for one scheduling variable")
    local_estimator: LocalEstimator | None
    lpv_estimator: LpvEstimator | None
    spectral_estimator: SpectralEstimator | None
    experiment_ids: list[str]
    design_id: str | None = Field(description="the design that all its experiments carry out, if it is one")
    parent_id: str | None = Field(description="the model that this one is a new version of")
    seed: Integer | None = Field(description="seed of what was drawn at random; null when nothing was")
    state_space: StateSpaceResult | None = Field(default=None, description="of a state-space model; null for others")
    varying: VaryingResult | None = Field(
        default=None, description="of a model from a record along varying scheduling; null for others"
    )
    effects: list[PlacedEffectDocument] = Field(
        default_factory=list,
        description="physical effects in the model; theta is that of the plant, poles heed those on coefficients",
    )
    joint_parameter_names: list[str] = Field(
        default_factory=list, description="entries of theta that belong to G, then the parameters of the effects"
    )
    joint_covariance: Matrix | None = Field(
        default=None, description="of these together; null without effects and where the data leave them open"
    )
    extension: ExtensionReport | None = Field(default=None, description="what the last effect brought")


class ModelList(CamelModel):
    """A page of models."""

    items: list[Model]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")


class ModelFrequencyResponse(CamelModel):
    """The frequency response of a model at one operating point, with 95 % bands to first order in the covariance."""

    model_id: str
    operating_point: Vector
    input_number: Integer = Field(default=1, description="which input, counted from 1")
    output_number: Integer = Field(default=1, description="which output, counted from 1")
    frequencies_rad_per_second: Vector
    response: ComplexVector
    magnitude: Vector
    magnitude_lower95: Vector | None = Field(description="null when the covariance is not known")
    magnitude_upper95: Vector | None
    phase_rad: Vector = Field(description="continuous in frequency, whatever the grid; delays counted in full")
    phase_lower95_rad: Vector | None
    phase_upper95_rad: Vector | None
    real_variance: Vector | None
    imaginary_variance: Vector | None
    real_imaginary_covariance: Vector | None
    left_out_effects: list[str] = Field(
        default_factory=list,
        description="effects of the model that no frequency response can hold, as they act on signals (the response is"
        " that of the linear core), or that belong to single measurements",
    )
