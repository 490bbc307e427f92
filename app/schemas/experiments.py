"""Experiments: what was measured at one operating point, and what was understood of it."""

from typing import Annotated, Literal

from pydantic import Field, RootModel

from app.arrays import ComplexVector
from app.schemas.common import CamelModel, Double, Integer, Timestamp
from app.schemas.plants import LongText, OperatingPoint, Positive, SampleTime, Text

Identifier = Annotated[str, Field(min_length=1, max_length=64)]
Values = list[Double]


class ExperimentFields(CamelModel):
    """What every experiment states."""

    plant_id: Identifier = Field(description="the plant that was measured")
    name: Text = ""
    description: LongText = ""
    operating_point: OperatingPoint = Field(description="one value a scheduling variable, constant while measuring")
    design_id: Identifier | None = Field(default=None, description="the design that this experiment carries out")


class TimeRecordRequest(ExperimentFields):
    """Input and output over time."""

    kind: Literal["timeRecord"]
    sample_time_seconds: SampleTime
    input: Values = Field(description="input, one value a sample, in the unit of the plant's input")
    output: Values = Field(description="output, as many values as the input")
    period_samples: Annotated[Integer, Field(ge=2)] | None = Field(
        default=None, description="samples in one period of a periodic input; null when it is not or unknown"
    )


class FrequencyResponseRequest(ExperimentFields):
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


class ExperimentRequest(
    RootModel[Annotated[TimeRecordRequest | FrequencyResponseRequest, Field(discriminator="kind")]]
):
    """A time record or a frequency response, told apart by `kind`."""


class FileFields(ExperimentFields):
    """What is stated beside an uploaded file; it goes before what the file says."""

    sample_time_seconds: SampleTime | None = Field(default=None, description="needed when the file has no time")
    period_samples: Annotated[Integer, Field(ge=2)] | None = Field(default=None, description="samples in one period")
    variable_group: Text = Field(
        default="", description="structure of a mat file that holds the arrays, e.g. data.run1"
    )


class Understanding(CamelModel):
    """What was understood of a measurement; null where it does not apply or cannot be known from it."""

    samples: Integer | None = Field(default=None, description="samples of a time record")
    duration_seconds: Double | None = Field(default=None, description="length of a time record")
    period_samples: Integer | None = Field(default=None, description="samples in one period, stated or found")
    period_detected: bool = Field(default=False, description="the period was found, not stated")
    periods: Integer | None = Field(default=None, description="whole periods in the record")
    transient_periods: Integer | None = Field(default=None, description="leading periods that show a transient")
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
    warnings: list[str] = Field(description="what may spoil an identification")


class Experiment(ExperimentFields):
    """An experiment; its arrays are found under `/data` and `/file`."""

    id: str
    created_at: Timestamp
    job_id: str | None
    software_version: str
    kind: Literal["timeRecord", "frequencyResponse"]
    sample_time_seconds: Double | None = Field(description="null for a frequency response in continuous time")
    variance_known: bool = Field(description="whether variances came with the frequency response")
    variance_degrees_of_freedom: Double | None = Field(description="of these variances; null when known exactly")
    source: Literal["json", "csv", "npz", "mat"] = Field(description="how the data came")
    file_name: str | None = Field(default=None, description="name of the uploaded file")
    understood: Understanding


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


class FrequencyResponseData(CamelModel):
    """The values of a frequency response."""

    kind: Literal["frequencyResponse"]
    frequencies_rad_per_second: Values
    response: ComplexVector
    variance: Values | None


class ExperimentData(RootModel[Annotated[TimeRecordData | FrequencyResponseData, Field(discriminator="kind")]]):
    """The arrays of an experiment."""
