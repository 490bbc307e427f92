"""Comparisons of models with measurements."""

from typing import Annotated, Literal

from pydantic import Field

from app.arrays import ComplexVector, Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.experiments import Identifier
from app.schemas.outcomes import TestDocument
from app.schemas.plants import LongText, Text

ExperimentIds = Annotated[list[Identifier], Field(min_length=1, max_length=1000)]
Data = Literal["fitted", "heldOut"]
LineClass = Literal["excited", "unexcitedOdd", "unexcitedEven"]


class ComparisonRequest(CamelModel):
    """Which model to hold against which experiments."""

    model_id: Identifier
    experiment_ids: ExperimentIds = Field(description="experiments of the plant of the model, fitted or held out")
    name: Text = ""
    description: LongText = ""
    mean_value: bool = Field(default=True, description="compare the mean value of periodic records too")


class ComparedExperiment(CamelModel):
    """How well the model explains one experiment."""

    experiment_id: str
    operating_point: Vector | None = Field(description="null where the scheduling varied")
    data: Data = Field(description="whether the model, or a version before it, was fitted to this experiment")
    fit_percent: Double | None = Field(
        description="100 (1 − ‖y − ŷ‖/‖y‖) at the excited lines, null for zero output; where the scheduling varied the"
        " best fit rate over time"
    )
    refit_percent: Double | None = Field(
        default=None, description="what that would be after a refit to the fitted experiments; null if held out"
    )
    vaf_percent: Double | None = Field(
        default=None, description="variance accounted for over time, where the scheduling varied"
    )


class PointTest(CamelModel):
    """Lack of fit at one operating point."""

    operating_point: Vector
    test: TestDocument


class BandTest(CamelModel):
    """Lack of fit in one band of frequencies."""

    minimum_rad_per_second: Double
    maximum_rad_per_second: Double | None = Field(description="null: all above")
    test: TestDocument


class DisturbanceDocument(CamelModel):
    """A sine wave in the output that does not repeat with the period, such as mains hum."""

    experiment_id: str
    frequency_rad_per_second: Double
    frequency_deviation_rad_per_second: Double
    amplitude: Double = Field(description="in the unit of the output")
    amplitude_deviation: Double
    phase_rad: Double = Field(description="of the cosine at the first sample")
    p_value: Double


class NoteDocument(CamelModel):
    """What is to be said of one experiment."""

    experiment_id: str
    text: str


class ComparisonPart(CamelModel):
    """Tests of the experiments that were fitted, or of those that were held out, or of one with varying scheduling.

    The model is held against the data as it is. Fitted: its parameters are taken off the degrees of freedom, and
    what a refit to these data would bring is told beside it. Held out: the uncertainty of the model is added to
    that of the noise. All tests are null or empty where the size of the noise is not known.
    """

    data: Data
    scheduling: Literal["still", "varying"] = Field(
        default="still", description="still: all experiments at operating points; varying: one record along p(t)"
    )
    experiment_id: str | None = Field(default=None, description="that record")
    noise_known: bool = Field(description="whether the size of the noise is known from variances or periods")
    lack_of_fit: TestDocument | None = Field(description="the whitened residuals against the noise")
    refitted: TestDocument | None = Field(
        default=None, description="what that would be after a refit to these experiments; null if held out"
    )
    by_point: list[PointTest]
    by_band: list[BandTest] = Field(description="below, in six bands over, and above the excited frequencies")
    by_line_class: list[TestDocument] = Field(
        description="excited lines show linear misfit, unexcited odd and even ones odd and even nonlinearity"
    )
    dependence: TestDocument | None = Field(
        description="whether one LTI model per operating point would fit better than a refit; null if held out"
    )
    dynamics: TestDocument | None = Field(description="whether even those do not fit; null if held out")
    between_harmonics: list[TestDocument] = Field(description="disturbances with frequencies of their own")
    disturbances: list[DisturbanceDocument] = Field(
        default_factory=list, description="the strongest of them in each experiment that has one, fitted"
    )
    notes: list[NoteDocument] = Field(
        default_factory=list, description="what to mind of single experiments, such as noise that could not be told"
    )
    simulation_errors: list[TestDocument] = Field(
        default_factory=list,
        description="of a record along p(t) that is not synchronised: is y − ŷ white and normal, and independent"
        " of past input and scheduling",
    )


class Comparison(CamelModel):
    """A model held against measurements; the maps for pictures are found under `/maps` and `/file`."""

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    description: LongText
    model_id: str
    mean_value: bool
    experiments: list[ComparedExperiment]
    parts: list[ComparisonPart] = Field(
        description="first what was fitted, then what was held out, where given; then each record along p(t)"
    )


class ComparisonList(CamelModel):
    """A page of comparisons."""

    items: list[Comparison]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")


class ResidualRow(CamelModel):
    """Normalised residuals of one experiment, one a compared line."""

    experiment_id: str
    operating_point: Vector | None = Field(description="null where the scheduling varied")
    output_number: Integer = Field(default=1, description="which output, counted from 1")
    data: Data
    frequencies_rad_per_second: Vector
    residual: ComplexVector = Field(description="z with E|z|² = 1 where the model explains the measurement")
    line_classes: list[LineClass]


class TimeResidualRow(CamelModel):
    """What the model leaves of one output of a record along varying scheduling."""

    experiment_id: str
    output_number: Integer
    data: Data
    sample_time_seconds: Double
    residual: Vector = Field(description="y − ŷ in units of the deviation of the noise where that is known")


class ComparisonMaps(CamelModel):
    """Normalised residuals over operating point and frequency, one row an experiment and output."""

    comparison_id: str
    rows: list[ResidualRow]
    time_rows: list[TimeResidualRow] = Field(
        default_factory=list, description="over time, of records along varying scheduling"
    )


class ComparedResponse(CamelModel):
    """Output over input of one experiment at its excited lines, as measured and as the model answers to this input."""

    comparison_id: str
    experiment_id: str
    operating_point: Vector
    data: Data
    frequencies_rad_per_second: Vector
    measured: ComplexVector
    standard_deviation: Vector | None = Field(
        description="root of the mean of |noise|² on the measured values; null where the size of the noise is not known"
    )
    modelled: ComplexVector = Field(
        description="where effects act on signals this belongs to the input, and differs from the response of the model"
    )
