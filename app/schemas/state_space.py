"""State-space models: what to identify them with, and what was found."""

from typing import Annotated, Literal

from pydantic import Field

from app.arrays import Matrices, Matrix, Vector
from app.schemas.common import CamelModel, Double, Integer
from app.schemas.experiments import Identifier
from app.schemas.families import ParametricEstimator, Refinement, SpectralEstimator, SubspaceEstimator
from app.schemas.outcomes import OutcomeDocument, PolesAtPoint
from app.schemas.plants import CoefficientBasis, LongText, ProductBasisDocument, StateSpaceStructureDocument, Text
from app.schemas.requests import KindRequest


class StateSpaceModelRequest(KindRequest):
    """Which experiments to identify state-space models from: one an operating point, one over the range, or both."""

    kind: Literal["stateSpace"]
    plant_id: Identifier
    name: Text = ""
    description: LongText = ""
    experiment_ids: Annotated[list[Identifier], Field(min_length=1, max_length=1000)] = Field(
        description="experiments of this plant, one an operating point"
    )
    subspace_estimator: SubspaceEstimator | None = Field(
        default=None, description="how models of single operating points are found; null: none are made"
    )
    parametric_estimator: ParametricEstimator | None = Field(
        default=None, description="how the parameter-varying model is found; null: none is made"
    )
    refinement: Refinement | None = Field(default=None, description="what improves the parameter-varying model")
    spectral_estimator: SpectralEstimator | None = Field(
        default=None, description="how time records become frequency responses"
    )
    structure: StateSpaceStructureDocument | None = Field(
        default=None, description="in place of the structure of the plant, e.g. for another order"
    )
    basis: ProductBasisDocument | None = Field(default=None, description="in place of the basis of the plant")
    coefficient_bases: list[CoefficientBasis] | None = Field(default=None, description="in place of those of the plant")


class MatricesDocument(CamelModel):
    """The matrices of a parameter-varying model, each a list with one matrix for each function of its basis."""

    matrix_a: Matrices
    matrix_b: Matrices
    matrix_c: Matrices
    matrix_d: Matrices


class ResponseErrorDocument(CamelModel):
    """How far a model is from a measured response, in Frobenius norms over outputs and inputs."""

    experiment_id: str
    operating_point: Vector
    max_error: Double = Field(description="largest error of all lines, in units of the response")
    rms_error: Double = Field(description="root mean square of the errors of all lines, in units of the response")
    relative_error: Double | None = Field(description="rmsError over the root mean square of the response")


class OrderTrialDocument(CamelModel):
    """One row of the table of orders: a model from every second line, judged on the lines between them."""

    order: Integer
    singular_value: Double = Field(description="the one that the order adds, over the largest")
    rms_error: Double = Field(description="on the lines used")
    held_out_rms_error: Double
    held_out_max_error: Double
    stable: bool


class LocalStateSpaceModel(CamelModel):
    """The state-space model of one operating point."""

    experiment_id: str
    operating_point: Vector
    order: Integer
    sample_time_seconds: Double | None = Field(description="null in continuous time")
    matrix_a: Matrix
    matrix_b: Matrix
    matrix_c: Matrix
    matrix_d: Matrix
    poles: PolesAtPoint
    stable: bool
    outcome: OutcomeDocument
    block_rows: Integer = Field(description="block rows q of the observability matrix")
    singular_values: Vector = Field(description="largest first; the order shows where they fall")
    order_table: list[OrderTrialDocument] = Field(description="empty unless the order was to be chosen or asked for")
    max_error: Double = Field(description="largest error of all lines, in units of the response")
    rms_error: Double = Field(description="root mean square of the errors of all lines, in units of the response")
    relative_error: Double = Field(description="rmsError over the root mean square of the response")


class SingularValues(CamelModel):
    """Singular values of one operating point."""

    operating_point: Vector
    values: Vector = Field(description="largest first; the order shows where they fall")


class ChosenRows(CamelModel):
    """The rows of the observability matrix that are the state basis at all operating points."""

    counts: list[Integer] = Field(description="block rows of each output")
    indices: list[Integer] = Field(description="the rows, from zero")
    worst_singular_value: Double = Field(description="conditioning at all operating points: 1 is perfect, 0 fails")


class PoleGuarantee(CamelModel):
    """What is known of the poles with regard to the region asked for; an excess is below zero inside of it."""

    guaranteed: Literal["wholeRange", "grid"] = Field(
        description="wholeRange: proved for every operating point by those at the corners; grid: imposed and checked on"
        " a grid only"
    )
    operating_points: Integer = Field(description="how many the region was imposed at")
    certificate: Double | None = Field(
        description="below zero proves the poles at these points inside; null after a refinement, which has no proof"
    )
    worst_excess: Double = Field(description="largest excess on a fine grid of the range")
    worst_excess_without_region: Double | None = Field(description="that of the model without region")
    relative_error: Double = Field(description="over all experiments")
    relative_error_without_region: Double | None = Field(description="that of the model without region")


class StateSpaceResult(CamelModel):
    """What belongs to a state-space model only."""

    subspace_estimator: SubspaceEstimator | None
    parametric_estimator: ParametricEstimator | None
    refinement: Refinement | None
    order: Integer | None = Field(description="null when there is no parameter-varying model")
    sample_time_seconds: Double | None = Field(description="null in continuous time")
    input_count: Integer
    output_count: Integer
    matrices: MatricesDocument | None = Field(description="null when there is no parameter-varying model")
    errors: list[ResponseErrorDocument] = Field(description="of the parameter-varying model, one an experiment")
    singular_values: list[SingularValues] = Field(description="of the parametric estimator, one an experiment")
    chosen_rows: ChosenRows | None
    pole_guarantee: PoleGuarantee | None = Field(description="null when no pole region was asked for")
    local_models: list[LocalStateSpaceModel] = Field(description="of the subspace estimator, one an experiment")
