"""Plants: what is measured and controlled, what the dynamics depend on, and the model structure meant for it."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.families import Basis
from app.schemas.plug_ins import named_union
from app.schemas.quantities import QuantityName
from identification.models.physical import Coefficient, PhysicalForm
from identification.models.rational import RationalStructure

Text = Annotated[str, Field(max_length=200)]
Name = Annotated[str, Field(min_length=1, max_length=200)]
LongText = Annotated[str, Field(max_length=10_000)]
Order = Annotated[Integer, Field(ge=0, le=30)]
StateOrder = Annotated[Integer, Field(ge=1, le=100)]
Positive = Annotated[Double, Field(gt=0)]
SampleTime = Annotated[Double, Field(ge=1e-15, le=1e15)]
OperatingPoint = Annotated[list[Double], Field(min_length=1, max_length=10)]


class SchedulingVariableDocument(CamelModel):
    """A quantity that the dynamics depend on and that can be held still."""

    name: Name = Field(description="what it is, e.g. speed")
    unit: Text = Field(default="", description="unit of all its values")
    minimum: Double = Field(description="lower end of the range that the model is for")
    maximum: Double = Field(description="upper end of the range that the model is for")


class SignalDescription(CamelModel):
    """What the input or the output is."""

    name: Name = Field(description="what it is, e.g. motor current")
    unit: Text = Field(default="", description="its unit")
    quantity: QuantityName | None = Field(
        default=None,
        description="what it measures: comparison and diagnosis see by it how forces meet the motion; where it is not"
        " stated a diagnosis tries position, speed and acceleration",
    )


class DiscreteTimeStructure(CamelModel):
    """Orders of y = (B/A) u + (C/D) e in discrete time."""

    time_domain: Literal["discrete"]
    sample_time_seconds: SampleTime = Field(description="sample time of records and model")
    na: Order = Field(description="order of A = 1 + a1 q + …, q the delay by one sample")
    nb: Order = Field(description="order of B = q^nk (b0 + b1 q + … + b_nb q^nb)")
    nk: Annotated[Integer, Field(ge=0, le=10_000)] = Field(default=0, description="samples of delay")
    nc: Order = Field(default=0, description="order of C = 1 + c1 q + …")
    nd: Order = Field(default=0, description="order of D = 1 + d1 q + …")
    delay: bool = Field(default=False, description="estimate a further delay tau in seconds")

    def structure(self) -> RationalStructure:
        """What it stands for."""
        orders = (self.na, self.nb, self.nk, self.nc, self.nd)
        return RationalStructure(*orders, sample_time=self.sample_time_seconds, delay=self.delay)

    @property
    def words(self) -> str:
        """It in a few words."""
        orders = f"na {self.na}, nb {self.nb}, nk {self.nk}, nc {self.nc}, nd {self.nd}"
        return f"discrete time, {self.sample_time_seconds:g} s; {orders}"


class ContinuousTimeStructure(CamelModel):
    """Orders of G = exp(−jωτ) B/A in continuous time, x = jω/frequencyScaleRadPerSecond."""

    time_domain: Literal["continuous"]
    na: Order = Field(description="order of A = x^na + a1 x^(na−1) + … + a_na")
    nb: Order = Field(description="order of B = b0 x^nb + … + b_nb; it may exceed na")
    delay: bool = Field(default=False, description="estimate a delay tau in seconds")
    frequency_scale_rad_per_second: Annotated[Double, Field(ge=1e-15, le=1e15)] = Field(
        default=1.0, description="frequency that coefficients are scaled by; choose one in the middle of the data"
    )

    def structure(self) -> RationalStructure:
        """What it stands for."""
        scale = self.frequency_scale_rad_per_second
        return RationalStructure(self.na, self.nb, frequency_scale=scale, delay=self.delay)

    @property
    def words(self) -> str:
        """It in a few words."""
        return f"continuous time; na {self.na}, nb {self.nb}"


class PhysicalCoefficient(CamelModel):
    """One coefficient of the differential equation."""

    name: Name = Field(description="what it is called, e.g. J; the name of its parameters")
    unit: Text = Field(default="", description="its unit, with time in seconds")
    fixed_at: Double | None = Field(default=None, description="its known value; left out when it is to be estimated")

    @property
    def words(self) -> str:
        """It in a few words."""
        known = "" if self.fixed_at is None else f" = {self.fixed_at:g}"
        return (f"{self.name} ({self.unit})" if self.unit else self.name) + known


PhysicalCoefficients = Annotated[list[PhysicalCoefficient], Field(min_length=1, max_length=31)]


class PhysicalFormStructure(CamelModel):
    """G = exp(−jωτ) B/A in continuous time with the coefficients of physics, exactly one of them known.

    For J dω/dt + d ω = k u with known k: denominator J, d; numerator k fixed.
    """

    time_domain: Literal["continuousPhysical"]
    denominator: PhysicalCoefficients = Field(description="of the output's derivatives, the highest first")
    numerator: PhysicalCoefficients = Field(description="of the input's derivatives, the highest first")
    delay: bool = Field(default=False, description="estimate a delay tau in seconds")
    frequency_scale_rad_per_second: Annotated[Double, Field(ge=1e-15, le=1e15)] = Field(
        default=1.0, description="a frequency in the middle of the data"
    )

    def structure(self) -> PhysicalForm:
        """What it stands for."""
        output, input = (
            tuple(Coefficient(one.name, one.unit, one.fixed_at) for one in side)
            for side in (self.denominator, self.numerator)
        )
        return PhysicalForm(output, input, self.frequency_scale_rad_per_second, self.delay)

    @property
    def words(self) -> str:
        """It in a few words."""
        output, input = (", ".join(one.words for one in side) for side in (self.denominator, self.numerator))
        return f"continuous time; output: {output}; input: {input}"


class StateSpaceStructure(CamelModel):
    """What state-space structures of both time domains state."""

    order: StateOrder | None = Field(
        default=None,
        description="number of states; null: chosen by the estimator, where it can",
    )

    @property
    def words(self) -> str:
        """It in a few words."""
        return "state space"


class DiscreteStateSpaceStructure(StateSpaceStructure):
    """x(t + T) = A x + B u, y = C x + D u, with as many inputs and outputs as the plant has."""

    time_domain: Literal["discreteStateSpace"]
    sample_time_seconds: SampleTime = Field(description="sample time T of responses and model")


class ContinuousStateSpaceStructure(StateSpaceStructure):
    """dx/dt = A x + B u, y = C x + D u, with as many inputs and outputs as the plant has."""

    time_domain: Literal["continuousStateSpace"]


class ProductBasisDocument(CamelModel):
    """Products of basis functions, one factor for each scheduling variable."""

    factors: Annotated[list[Basis], Field(min_length=1, max_length=10)] = Field(description="one a scheduling variable")
    total_degree: Annotated[Integer, Field(ge=0)] | None = Field(
        default=None, description="highest sum of indices that is kept; null keeps all products"
    )


class CoefficientBasis(CamelModel):
    """The basis of one coefficient, or of one matrix of a state-space model, in place of the common one."""

    coefficient: Name = Field(
        description="name of the coefficient, e.g. a1, b0, tau, or A, B, C, D; polynomials of degree 0 keep it constant"
    )
    basis: ProductBasisDocument


RATIONAL = (DiscreteTimeStructure, ContinuousTimeStructure, PhysicalFormStructure)
STATE_SPACE = (DiscreteStateSpaceStructure, ContinuousStateSpaceStructure)

if TYPE_CHECKING:
    RationalStructureDocument = DiscreteTimeStructure | ContinuousTimeStructure | PhysicalFormStructure
    StateSpaceStructureDocument = DiscreteStateSpaceStructure | ContinuousStateSpaceStructure
    Structure = RationalStructureDocument | StateSpaceStructureDocument
else:
    RationalStructureDocument = named_union("RationalStructure", RATIONAL, "time_domain")
    StateSpaceStructureDocument = named_union("StateSpaceStructure", STATE_SPACE, "time_domain")
    Structure = named_union("Structure", RATIONAL + STATE_SPACE, "time_domain")

Signals = Annotated[list[SignalDescription], Field(min_length=1, max_length=50)]


class PlantRequest(CamelModel):
    """A plant to describe: rational with `input` and `output`, or in state space with `inputs` and `outputs`."""

    name: Name
    description: LongText = ""
    scheduling_variables: Annotated[list[SchedulingVariableDocument], Field(min_length=1, max_length=10)]
    input: SignalDescription | None = Field(default=None, description="of a rational structure")
    output: SignalDescription | None = Field(default=None, description="of a rational structure")
    inputs: Signals | None = Field(default=None, description="of a state-space structure")
    outputs: Signals | None = Field(default=None, description="of a state-space structure")
    structure: Structure = Field(description="model structure")
    basis: ProductBasisDocument = Field(
        description="how all coefficients, or all matrices of a state-space model, depend on the scheduling variables"
    )
    coefficient_bases: list[CoefficientBasis] = Field(default_factory=list, description="exceptions to `basis`")


class Plant(PlantRequest):
    """A plant, with what follows from its structure."""

    id: str
    created_at: Timestamp
    software_version: str
    parameter_names: list[str] = Field(
        description="names of the entries of theta, in order; of a state-space structure the matrices of each function"
    )
    needed_operating_points: int = Field(description="least number of distinct operating points that determine theta")


class PlantList(CamelModel):
    """A page of plants."""

    items: list[Plant]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")
