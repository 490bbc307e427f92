"""Experiments: what was measured at one operating point or along varying scheduling, and what was understood of it."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, RootModel, field_validator

from app.arrays import ComplexMatrices, ComplexVector, Matrices, matrices_shape
from app.files.roles import CHOICES
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.conditions import RecordConditions
from app.schemas.plants import LongText, Name, OperatingPoint, Positive, SampleTime, Text

Identifier = Annotated[str, Field(min_length=1, max_length=64)]
Values = list[Double]
ColumnChoice = Annotated[str, Field(pattern=f"^-?({'|'.join(CHOICES)})=.{{1,200}}$")]
ColumnStatement = Annotated[str, Field(pattern="^.{1,200}=.{1,200}$")]
ExperimentKind = Literal["timeRecord", "frequencyResponse", "matrixFrequencyResponse", "varyingRecord"]


class LoggedQuantity(CamelModel):
    """A quantity that was written down while measuring, and that is no scheduling variable."""

    name: Name = Field(description="what it is, e.g. ambient temperature")
    unit: Text = Field(default="", description="its unit; the same in all experiments that are to be compared")
    value: Double = Field(description="its mean during the experiment")


def _named_once(quantities: list[LoggedQuantity]) -> list[LoggedQuantity]:
    if len({one.name for one in quantities}) < len(quantities):
        raise ValueError("a quantity is named twice; give one value for each")
    return quantities


LoggedQuantities = Annotated[list[LoggedQuantity], Field(max_length=20), AfterValidator(_named_once)]


class ExperimentFields(CamelModel):
    """What every experiment states."""

    plant_id: Identifier = Field(description="the plant that was measured")
    name: Text = ""
    description: LongText = ""
    design_id: Identifier | None = Field(default=None, description="the design that this experiment carries out")
    logged_quantities: LoggedQuantities = Field(
        default_factory=list, description="such as temperatures; a diagnosis asks whether the plant depends on them"
    )


class LocalExperimentFields(ExperimentFields):
    """What every experiment at one operating point states."""

    operating_point: OperatingPoint = Field(description="one value a scheduling variable, constant while measuring")


class TimeRecordRequest(LocalExperimentFields, RecordConditions):
    """Input and output over time."""

    kind: Literal["timeRecord"]
    sample_time_seconds: SampleTime
    input: Values = Field(description="input, one value a sample, in the unit of the plant's input")
    output: Values = Field(description="output, as many values as the input")
    period_samples: Annotated[Integer, Field(ge=2)] | None = Field(
        default=None, description="samples in one period of a periodic input; null when it is not or unknown"
    )
    reference: Values | None = Field(
        default=None,
        description="what the controller was asked for, as many values as the input; stated with `feedback` only",
    )


class FrequencyResponseRequest(LocalExperimentFields):
    """A measured frequency response."""

    kind: Literal["frequencyResponse"]
    sample_time_seconds: SampleTime | None = Field(default=None, description="null for continuous time")
    frequencies_rad_per_second: Values = Field(description="distinct frequencies, zero or more")
    response: ComplexVector = Field(description="output over input, one value a frequency")
    variance: Values | None = Field(
        default=None, description="E|noise|² of each value (real and imaginary part half of it each); null if unknown"
    )
    variance_degrees_of_freedom: Positive | None = Field(
        default=None, description="degrees of freedom of estimated variances; null when they are known exactly"
    )


class MatrixFrequencyResponseRequest(LocalExperimentFields):
    """A measured frequency response with several inputs or outputs."""

    kind: Literal["matrixFrequencyResponse"]
    sample_time_seconds: SampleTime | None = Field(default=None, description="null for continuous time")
    frequencies_rad_per_second: Values = Field(description="distinct frequencies, zero or more")
    response: ComplexMatrices = Field(description="one matrix a frequency: a row for each output, a column each input")
    variance: Matrices | None = Field(
        default=None, description="E|noise|² of each entry of each matrix (real and imaginary part half of it each)"
    )
    variance_degrees_of_freedom: Positive | None = Field(
        default=None, description="degrees of freedom of estimated variances; null when they are known exactly"
    )

    @field_validator("variance")
    @classmethod
    def _of_one_shape(cls, variance: Matrices | None) -> Matrices | None:
        if variance is not None:
            matrices_shape(variance, "variance")
        return variance


Channels = Annotated[list[Values], Field(min_length=1, max_length=50)]


class VaryingRecordRequest(ExperimentFields):
    """Inputs, outputs and measured scheduling signals over time."""

    kind: Literal["varyingRecord"]
    sample_time_seconds: SampleTime
    inputs: Channels = Field(description="one list of samples for each input of the plant, in its order and units")
    outputs: Channels = Field(description="one list of samples for each output of the plant")
    scheduling: Channels = Field(description="one list of samples for each scheduling variable, in its range")
    period_samples: Annotated[Integer, Field(ge=2)] | None = Field(
        default=None,
        description="samples after which input and scheduling both repeat themselves; null when it is to be found, or"
        " when there is none",
    )


class ExperimentRequest(
    RootModel[
        Annotated[
            TimeRecordRequest | FrequencyResponseRequest | MatrixFrequencyResponseRequest | VaryingRecordRequest,
            Field(discriminator="kind"),
        ]
    ]
):
    """A time record, a frequency response or a record along varying scheduling, told apart by `kind`."""


class FileFields(ExperimentFields, RecordConditions):
    """What is stated beside an uploaded file; it goes before what the file says."""

    operating_point: OperatingPoint | None = Field(
        default=None,
        description="one value a scheduling variable, constant while measuring; left out when the file holds the"
        " scheduling signals",
    )
    scheduling_columns: Annotated[list[Name], Field(max_length=10)] | None = Field(
        default=None,
        description="columns or arrays of the file that hold the scheduling signals, one a variable; left out: those"
        " named as the scheduling variables, or p, p1, p2, …",
    )
    sample_time_seconds: SampleTime | None = Field(default=None, description="needed when the file has no time")
    period_samples: Annotated[Integer, Field(ge=2)] | None = Field(default=None, description="samples in one period")
    variable_group: Text = Field(
        default="", description="structure of a mat file that holds the arrays, e.g. data.run1"
    )
    columns: Annotated[list[ColumnChoice], Field(max_length=200)] = Field(
        default_factory=list,
        description="which column or array is what, e.g. input=force; with a minus, such as -responseIm=Zim, where it"
        " holds the negative; found by names and units where not said",
    )
    units: Annotated[list[ColumnStatement], Field(max_length=200)] = Field(
        default_factory=list, description="units of columns whose names do not say them, e.g. Frequency=Hz, phase=deg"
    )
    rows: Annotated[list[ColumnStatement], Field(max_length=10)] = Field(
        default_factory=list, description="only the lines with these values, e.g. run=2, of tables with several"
    )
    operating_point_columns: Annotated[list[Name], Field(min_length=1, max_length=10)] | None = Field(
        default=None,
        description="columns that hold the operating point, one a scheduling variable; one experiment is made of each",
    )
    averages: Annotated[Integer, Field(ge=2)] | None = Field(
        default=None, description="independent averages behind a coherence, which then becomes a variance"
    )


class SchedulingRange(CamelModel):
    """Where a scheduling signal ran."""

    name: str
    unit: str
    minimum: Double
    maximum: Double


class VaryingUnderstanding(CamelModel):
    """What was understood of a record along varying scheduling; null where it cannot be known."""

    ranges: list[SchedulingRange] = Field(description="of p(t), one a scheduling variable")
    synchronised: bool = Field(description="whether input and scheduling repeat themselves together")
    reason: str = Field(description="why they do not, and how far off they are; empty when they do")
    input_period_samples: Integer | None = Field(description="of the input by itself; 1 when it is constant")
    scheduling_period_samples: Integer | None = Field(description="of the scheduling by itself; 1 when it is constant")
    input_deviation: Double | None = Field(
        description="largest difference between samples one period apart, over the root mean square of what varies"
    )
    scheduling_deviation: Double | None = Field(description="likewise of the scheduling")
    steady_periods: Integer | None = Field(description="periods without transient")
    transient_rule: str | None = Field(description="by which leading periods were taken as transient")
    left_over_samples: Integer | None = Field(description="samples after the last whole period")
    noise_levels: Values | None = Field(description="standard deviation of the noise of each output")


class Understanding(CamelModel):
    """What was understood of a measurement; null where it does not apply or cannot be known from it."""

    samples: Integer | None = Field(default=None, description="samples of a time record")
    duration_seconds: Double | None = Field(default=None, description="length of a time record")
    period_samples: Integer | None = Field(default=None, description="samples in one period, stated or found")
    period_detected: bool = Field(default=False, description="the period was found, not stated")
    periods: Integer | None = Field(default=None, description="whole periods in the record")
    transient_periods: Integer | None = Field(default=None, description="leading periods that show a transient")
    input_count: Integer = Field(default=1, description="inputs")
    output_count: Integer = Field(default=1, description="outputs")
    frequency_count: Integer = Field(description="excited lines, or frequencies of the response")
    minimum_frequency_rad_per_second: Double | None = None
    maximum_frequency_rad_per_second: Double | None = None
    excited_frequencies_rad_per_second: Values | None = Field(default=None, description="of a record, at most 1000")
    frequency_spacing: Literal["linear", "logarithmic", "irregular"] | None = None
    noise_level: Double | None = Field(default=None, description="standard deviation of the output noise")
    signal_to_noise_decibel: Double | None = Field(default=None, description="periodic part of the output over noise")
    relative_deviation: Double | None = Field(default=None, description="median deviation of a response over its size")
    saturated_fraction: Double | None = Field(default=None, description="share of output samples at its extremes")
    input_offset: Double | None = Field(default=None, description="mean of the input")
    output_offset: Double | None = Field(default=None, description="mean of the output")
    output_trend: Double | None = Field(default=None, description="change of a significant straight line")
    outliers: Integer | None = Field(default=None, description="output samples far outside the noise")
    varying: VaryingUnderstanding | None = Field(
        default=None, description="of a record along varying scheduling; null for others"
    )
    warnings: list[str] = Field(description="what may spoil an identification")


class Experiment(ExperimentFields, RecordConditions):
    """An experiment; its arrays are found under `/data` and `/file`."""

    id: str
    created_at: Timestamp
    job_id: str | None
    software_version: str
    kind: ExperimentKind
    operating_point: OperatingPoint | None = Field(
        description="one value a scheduling variable, constant while measuring; null where the scheduling varied"
    )
    sample_time_seconds: Double | None = Field(description="null for a frequency response in continuous time")
    variance_known: bool = Field(description="whether variances came with the frequency response")
    variance_degrees_of_freedom: Double | None = Field(description="of these variances; null when known exactly")
    source: str = Field(description="how the data came: json, or the kind of file")
    file_name: str | None = Field(default=None, description="name of the uploaded file")
    columns: list[str] = Field(default_factory=list, description="what was stated of the columns of the file")
    units: list[str] = Field(default_factory=list, description="what was stated of their units")
    sibling_ids: list[str] = Field(
        default_factory=list, description="further experiments made of the same file, one an operating point"
    )
    understood: Understanding

    @property
    def held_at(self) -> list[float]:
        """The operating point of an experiment in which it was held still."""
        assert self.operating_point is not None, "the scheduling varied"
        return self.operating_point


class ExperimentList(CamelModel):
    """A page of experiments."""

    items: list[Experiment]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")


class TimeRecordData(CamelModel):
    """The samples of a time record."""

    kind: Literal["timeRecord"]
    sample_time_seconds: Double
    input: Values
    output: Values


class VaryingRecordData(CamelModel):
    """The samples of a record along varying scheduling, one list a channel."""

    kind: Literal["varyingRecord"]
    sample_time_seconds: Double
    inputs: list[Values]
    outputs: list[Values]
    scheduling: list[Values]


class FrequencyResponseData(CamelModel):
    """The values of a frequency response."""

    kind: Literal["frequencyResponse"]
    frequencies_rad_per_second: Values
    response: ComplexVector
    variance: Values | None


class MatrixFrequencyResponseData(CamelModel):
    """The values of a frequency response with several inputs or outputs."""

    kind: Literal["matrixFrequencyResponse"]
    frequencies_rad_per_second: Values
    response: ComplexMatrices
    variance: Matrices | None


class ExperimentData(
    RootModel[
        Annotated[
            TimeRecordData | FrequencyResponseData | MatrixFrequencyResponseData | VaryingRecordData,
            Field(discriminator="kind"),
        ]
    ]
):
    """The arrays of an experiment."""


class RecordSpectrumDocument(CamelModel):
    """Amplitudes of a time record at its lines, of the mean over steady periods; of at most 4000 lines."""

    experiment_id: str
    periods: Integer = Field(description="steady periods that the mean is taken over; 1 when the record has no period")
    frequencies_rad_per_second: Values
    input: Values = Field(description="amplitude, in the unit of the input")
    output: Values = Field(description="amplitude, in the unit of the output")
    noise: Values | None = Field(
        description="standard deviation of the output's amplitude; null when there is one period only"
    )
    excited: list[bool] = Field(description="whether the input excites the line")
