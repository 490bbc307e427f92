"""Designs: which experiments reach the accuracy asked for with the least input energy."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from app.arrays import ComplexVector, Vector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.experiments import Identifier
from app.schemas.families import AccuracyTarget, Limit, SpectrumFamily
from app.schemas.outcomes import OutcomeDocument
from app.schemas.plants import LongText, OperatingPoint, Positive, SampleTime, Text
from app.schemas.plug_ins import named_union

MAX_POINTS = 20_000


class PointGrid(CamelModel):
    """Operating points one by one."""

    kind: Literal["grid"]
    points: Annotated[list[OperatingPoint], Field(min_length=1, max_length=MAX_POINTS)]


class GridAxis(CamelModel):
    """Equidistant values of one scheduling variable."""

    minimum: Double
    maximum: Double
    count: Annotated[Integer, Field(ge=1, le=MAX_POINTS)]


class AxesGrid(CamelModel):
    """All combinations of equidistant values, one axis a scheduling variable."""

    kind: Literal["gridAxes"]
    axes: Annotated[list[GridAxis], Field(min_length=1, max_length=10)]


class Box(CamelModel):
    """Any operating point between two corners; a grid is refined where it pays. Energy caps are not possible."""

    kind: Literal["box"]
    minimum: OperatingPoint
    maximum: OperatingPoint
    starting_count: Annotated[Integer, Field(ge=2, le=101)] = Field(
        default=17, description="values a scheduling variable in the grid that the search starts from"
    )


if TYPE_CHECKING:
    OperatingPoints = PointGrid | AxesGrid | Box
else:
    OperatingPoints = named_union("OperatingPoints", (PointGrid, AxesGrid, Box), "kind")


class Band(CamelModel):
    """Frequencies that may be excited."""

    minimum_rad_per_second: Annotated[Double, Field(ge=0)]
    maximum_rad_per_second: Positive


class PointCap(CamelModel):
    """The most energy at one operating point."""

    operating_point: OperatingPoint
    energy: Positive = Field(description="Σ u(t)², in the unit of the input squared")


class EnergyCaps(CamelModel):
    """The most input energy that is allowed at operating points."""

    default: Positive | None = Field(default=None, description="at every point without a cap of its own; null: none")
    per_point: list[PointCap] = Field(default_factory=list)


class PromiseRequest(CamelModel):
    """The targets hold with this probability over what is not known of the model, not only at its parameters.

    For plants without effects, with FIR or line spectra on a grid, and models with a covariance.
    """

    probability: Annotated[Double, Field(ge=0.5, lt=1)] = Field(
        default=0.95, description="that the targets are met at the true parameters"
    )
    noise_deviation: Annotated[Double, Field(ge=0, lt=1)] = Field(
        default=0.0, description="relative standard deviation of the noise variance of the model; 0: it is known"
    )
    seed: Annotated[Integer, Field(ge=0, le=2**53)] = Field(
        default=0, description="of the draws from the covariance of the model"
    )


class DesignRequest(CamelModel):
    """What accuracy is asked for, and what is allowed to reach it."""

    plant_id: Identifier
    model_id: Identifier = Field(description="what is known of the plant now")
    name: Text = ""
    description: LongText = ""
    operating_points: OperatingPoints = Field(description="where experiments may be done")
    excluded_points: list[OperatingPoint] = Field(default_factory=list, description="where they must not be done")
    targets: Annotated[list[AccuracyTarget], Field(min_length=1, max_length=100)]
    spectrum_family: SpectrumFamily = Field(description="what kind of input spectra")
    samples: Annotated[Integer, Field(ge=1, le=100_000_000)] = Field(
        description="samples of each local experiment; raised when the noise model needs more"
    )
    sample_time_seconds: SampleTime | None = Field(
        default=None, description="of the input to be played, for plants in continuous time"
    )
    band: Band | None = Field(default=None, description="frequencies that may be excited; null: all")
    energy_caps: EnergyCaps | None = None
    limits: Annotated[list[Limit], Field(max_length=20)] = Field(
        default_factory=list, description="what the plant may not do, over the samples of each experiment; on a grid"
    )
    use_prior_information: bool = Field(
        default=False, description="count the accuracy that the model already has, and design what is missing"
    )
    prior_experiment_ids: Annotated[list[Identifier], Field(min_length=1, max_length=1000)] | None = Field(
        default=None,
        description="in place of that, experiments whose information counts, also about effects that the model lacks",
    )
    promise: PromiseRequest | None = Field(
        default=None, description="null: the targets are met at the parameters of the model"
    )
    noise_variance: Positive | None = Field(
        default=None, description="of the white noise e, a sample; null: that of the model"
    )
    tolerance: Annotated[Double, Field(ge=1e-8, le=0.1)] = Field(
        default=1e-4, description="relative gap between energy and lower bound that is certified"
    )


class LineSpectrumDocument(CamelModel):
    """Energy on single frequencies."""

    kind: Literal["lines"]
    line_indices: list[Integer] = Field(description="which multiples of the lowest line of the period")
    frequencies_rad_per_second: Vector
    energies: Vector = Field(description="Σ u(t)² of each line")
    period_samples: Integer = Field(description="samples of the period that holds these lines")


class MultisineSpectrumDocument(CamelModel):
    """A signal of a fixed level, u(t) = Re Σ A e^{jωt}, and how many of its periods are played."""

    kind: Literal["multisine"]
    line_indices: list[Integer] = Field(description="which multiples of the lowest line of the period")
    frequencies_rad_per_second: Vector
    phasors: ComplexVector = Field(description="A of each line, in the unit of the input")
    level: Double = Field(description="root mean square of the signal")
    energies: Vector = Field(description="Σ u(t)² of each line over all periods")
    period_samples: Integer
    periods: Integer


class FirSpectrumDocument(CamelModel):
    """N Φ(ω) = c0 + 2 Σ c_i cos(iωT): the spectrum of white noise through an FIR filter, in units of energy."""

    kind: Literal["fir"]
    coefficients: Vector = Field(description="c0 … cL; c0 is the energy")


if TYPE_CHECKING:
    Spectrum = LineSpectrumDocument | FirSpectrumDocument | MultisineSpectrumDocument
else:
    Spectrum = named_union("Spectrum", (LineSpectrumDocument, FirSpectrumDocument, MultisineSpectrumDocument), "kind")


class SpectrumCurve(CamelModel):
    """A spectrum for plotting: energies of lines, or a density (per rad/sample, two-sided) over a grid."""

    frequencies_rad_per_second: Vector
    values: Vector


class DesignedExperimentDocument(CamelModel):
    """What to do at one operating point."""

    operating_point: Vector
    energy: Double = Field(description="Σ u(t)² over the experiment")
    spectrum: Spectrum
    curve: SpectrumCurve


class BindingDocument(CamelModel):
    """Something that the energy would be less without."""

    what: Literal["target", "cap", "limit"]
    target_index: Integer | None = Field(description="which of the targets, from zero; null for a cap or limit")
    limit_index: Integer | None = Field(default=None, description="which of the limits, from zero; null for others")
    operating_point: Vector | None = Field(description="where the cap or limit binds; null for a target")
    multiplier: Double | None = Field(
        description="of a target, its share of the energy; of a cap, the energy that one unit more would save; of a"
        " limit, the share of the energy that its mean square allowed to grow by its own size would save at this rate"
    )


class DecisionDocument(CamelModel):
    """What the experiments can be expected to decide about an effect."""

    target_index: Integer = Field(description="which of the targets, from zero")
    question: Literal["detection", "discrimination"]
    effect: str = Field(description="kind of the effect that is there")
    against: str | None = Field(description="kind of the effect that is to be rejected; null for a detection")
    amplitude: Double | None = Field(description="of the effect that is to be seen; null for a discrimination")
    expected_variance: Double | None = Field(
        description="of the amplitude, the largest in any direction; null for a discrimination, or when nothing is seen"
    )
    noncentrality: Double = Field(description="squared distance from the model without, or with the other effect")
    asked_power: Double
    level: Double
    expected_power: Double
    probability_of_weight_above95: Double | None = Field(
        description="that the diagnosis gives the right effect over 95 % of the weight; null for a detection"
    )


class PromiseDocument(CamelModel):
    """How a promise is kept, checked on fresh draws from the covariance of the model."""

    asked_probability: Double
    kept: Integer = Field(description="fresh draws at which all targets are met")
    checked: Integer = Field(description="fresh draws")
    lowest_probability: Double = Field(description="lower end of the exact 95 % interval (Clopper and Pearson)")
    highest_probability: Double
    scenarios: Integer = Field(description="models that the certified problem holds at once")
    scenario_gap: Double = Field(description="certified relative gap of that problem")
    scaling: Double = Field(description="of all energies, so that the promised share of a pool of draws is met")
    energy_at_estimate: Double = Field(description="that the parameters of the model alone would take")
    unstable_draws: Integer = Field(description="draws that were unstable and refused")


class Design(CamelModel):
    """The experiments that reach the accuracy asked for with the least energy, and the certificate of it."""

    id: str
    created_at: Timestamp
    software_version: str
    job_id: str | None
    request: DesignRequest = Field(description="what was asked for")
    plant_id: str
    model_id: str
    outcome: OutcomeDocument
    sample_time_seconds: Double
    experiments: list[DesignedExperimentDocument]
    total_energy: Double | None = Field(description="Σ u(t)² over all experiments; null when infeasible")
    least_energy: Double | None = Field(
        default=None, description="the same, and for candidate multisines with parts of periods"
    )
    lower_bound: Double | None = Field(description="no experiment at all within the request needs less energy")
    gap: Double | None = Field(description="(totalEnergy − lowerBound)/totalEnergy, of what is played")
    samples: Integer = Field(description="samples of each local experiment, as many as the noise model needs")
    required_samples: Double | None = Field(description="least number of samples for the accuracy of the noise model")
    parameter_names: list[str] = Field(description="those of the effects in the model stand between those of G and H")
    expected_covariance: list[list[Double | None]] | None = Field(
        description="of these parameters after the experiments; null for those that stay undetermined"
    )
    expected_standard_deviations: list[Double | None] | None = Field(
        description="of these parameters after the experiments; null for those that stay undetermined"
    )
    binding: list[BindingDocument]
    decisions: list[DecisionDocument] = Field(default_factory=list, description="of targets about effects")
    promise: PromiseDocument | None = Field(
        default=None,
        description="null without one; with one, lowerBound and gap refer to the targets at the model's parameters",
    )


class DesignList(CamelModel):
    """A page of designs."""

    items: list[Design]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")
