"""Models from experiments in which the scheduling varies: what to identify them with, and what was found."""

from typing import Annotated, Literal

from pydantic import Field

from app.arrays import ComplexVector, Matrix, Vector
from app.schemas.common import CamelModel, Double, Integer
from app.schemas.experiments import Identifier
from app.schemas.families import VaryingEstimator, VaryingRefinement
from app.schemas.plants import DiscreteStateSpaceStructure, LongText, ProductBasisDocument, Text
from app.schemas.requests import KindRequest


class VaryingModelRequest(KindRequest):
    """Which record along varying scheduling to identify a state-space model from, and how."""

    kind: Literal["varyingScheduling"]
    plant_id: Identifier
    name: Text = ""
    description: LongText = ""
    experiment_id: Identifier = Field(description="a record of this plant along varying scheduling")
    held_out_experiment_ids: Annotated[list[Identifier], Field(max_length=100)] = Field(
        default_factory=list, description="other such records, on which the model is judged"
    )
    estimator: VaryingEstimator = Field(description="how the model is found")
    refinement: VaryingRefinement | None = Field(
        default=None, description="maximum likelihood that starts from the model found; null: none"
    )
    basis: ProductBasisDocument | None = Field(
        default=None,
        description="functions of the scheduling variables that the matrices are sums over; 1 and each variable when"
        " left out",
    )
    structure: DiscreteStateSpaceStructure | None = Field(
        default=None, description="order and sample time in place of those of the plant's structure"
    )


class EigenvaluesDocument(CamelModel):
    """Eigenvalues of one A_i with the covariance of their real and imaginary parts; null where it is not known."""

    function: str = Field(
        description="what A_i is multiplied by: 1, powers of scheduling variables, or [indices] of functions"
    )
    eigenvalues: ComplexVector
    real_variances: list[Double | None]
    imaginary_variances: list[Double | None]
    real_imaginary_covariances: list[Double | None]


class NoiseSpectrumDocument(CamelModel):
    """The spectrum of the output noise, such that white noise has its variance at every frequency."""

    source: Literal["betweenHarmonics", "residuals"] = Field(
        description="lines between the harmonics of a synchronised record, or what the model leaves of the output"
    )
    frequencies_rad_per_second: Vector
    spectra: list[Vector] = Field(description="one list an output")
    covariance: Matrix = Field(description="of the noise of the outputs at one time")
    degrees_of_freedom: Double = Field(description="of each value of the spectra")


class VaryingFit(CamelModel):
    """How the model, simulated along p(t), reproduces one record."""

    experiment_id: str
    data: Literal["fitted", "heldOut"]
    bfr_percent: Double | None = Field(description="best fit rate, 100 (1 − Σ‖y − ŷ‖/Σ‖y − mean y‖); null: see reason")
    vaf_percent: Double | None = Field(description="variance accounted for, 100 (1 − var(y − ŷ)/var y)")
    reason: str = Field(default="", description="why there is no simulation, such as a model unstable along this p(t)")
    output_deviations: Vector | None = Field(
        description="Cramér–Rao bound on the standard deviation of each simulated output, root mean square over time;"
        " null without covariance"
    )


class SteadyPeriodsDocument(CamelModel):
    """What of a synchronised record was used."""

    period_samples: Integer
    scheduling_period_samples: Integer
    steady_periods: Integer
    dropped_periods: Integer
    left_over_samples: Integer
    transient_rule: str = Field(description="by which leading periods were dropped")
    deviation: Double = Field(description="largest difference between samples one period apart, relative")


class VaryingResult(CamelModel):
    """What belongs to a model from varying scheduling only."""

    estimator: VaryingEstimator
    refinement: VaryingRefinement | None
    starting_outcome: str = Field(description="what the estimator said before the refinement; empty without one")
    steady: SteadyPeriodsDocument | None = Field(description="null when the record is not synchronised")
    eigenvalues: list[EigenvaluesDocument] = Field(description="of A_i of each function, as in θ")
    noise_spectrum: NoiseSpectrumDocument | None = Field(description="null where it cannot be known")
    fits: list[VaryingFit] = Field(description="the fitted record first, then those held out")
    warnings: list[str] = Field(description="assumptions of the estimator that the data break")
