"""Experiments: documents and kept arrays to measurements."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.schemas.conditions import InputHold, RecordConditions
from app.schemas.experiments import (
    Experiment,
    ExperimentKind,
    FrequencyResponseRequest,
    LoggedQuantity,
    MatrixFrequencyResponseRequest,
    TimeRecordRequest,
)
from app.store.arrays import ArrayStore
from identification.arrays import FloatArray
from identification.channels import UNSTATED, Channels
from identification.comparison.batch import Batch
from identification.comparison.gather import gather
from identification.errors import MisuseError, ShapeError
from identification.models.model import Model, require_matching
from identification.signals import FrequencyResponse, Hold, Measurement, TimeRecord

Request = TimeRecordRequest | FrequencyResponseRequest | MatrixFrequencyResponseRequest


def requested_measurement(request: Request) -> Measurement:
    """The measurement in the body of a request; raises MisuseError when it is none."""
    point = tuple(request.operating_point)
    if isinstance(request, TimeRecordRequest):
        record = TimeRecord(
            np.array(request.input),
            np.array(request.output),
            request.sample_time_seconds,
            point,
            request.period_samples,
        )
        return under(request, record, reference=None if request.reference is None else np.array(request.reference))
    return plainest(
        FrequencyResponse(
            np.array(request.frequencies_rad_per_second),
            request.response.array(),
            point,
            request.sample_time_seconds,
            None if request.variance is None else np.array(request.variance),
            request.variance_degrees_of_freedom,
        )
    )


HOLDS: dict[InputHold, Hold] = {"zeroOrder": "zero", "firstOrder": "first", "bandLimited": "band"}


def under(
    conditions: RecordConditions,
    data: Measurement,
    channels: Channels = UNSTATED,
    reference: FloatArray | None = None,
) -> Measurement:
    """A measurement with what was stated of its channels; raises MisuseError for levels of a frequency response."""
    data = replace(data, channels=channels)
    if not conditions.stated and reference is None:
        return data
    if not isinstance(data, TimeRecord):
        raise MisuseError(
            "operating levels, hold and feedback are stated of time records, and this is a frequency response; leave"
            " them out",
            "record_conditions",
        )
    return replace(
        data,
        channels=Channels(
            replace(channels.input, level=conditions.input_level),
            replace(channels.output, level=conditions.output_level),
        ),
        hold=None if conditions.input_hold is None else HOLDS[conditions.input_hold],
        feedback=conditions.feedback or data.feedback,
        reference=data.reference if reference is None else reference,
    )


def plainest(data: FrequencyResponse) -> FrequencyResponse:
    """The measurement, with numbers in place of matrices when it has one input and one output."""
    return data.channel(0, 0) if data.response.ndim > 1 and data.input_count == data.output_count == 1 else data


def kind_of(data: Measurement) -> ExperimentKind:
    """What sort of measurement this is."""
    if isinstance(data, TimeRecord):
        return "timeRecord"
    return "frequencyResponse" if data.response.ndim == 1 else "matrixFrequencyResponse"


def require_channels(data: Measurement, channels: tuple[int, int]) -> None:
    """Raises ShapeError unless a measurement has this number of outputs and of inputs."""
    found = (1, 1) if isinstance(data, TimeRecord) else (data.output_count, data.input_count)
    if found != channels:
        what = "record" if isinstance(data, TimeRecord) else "response"
        raise ShapeError(
            f"the {what} has {found[0]} outputs and {found[1]} inputs, the plant has {channels[0]} and {channels[1]};"
            " give matrices with a row for each output and a column for each input of the plant",
            "output" if isinstance(data, TimeRecord) else "response",
        )


def kept_measurement(
    experiment: Experiment, arrays: Mapping[str, NDArray[Any]], channels: Channels = UNSTATED
) -> Measurement:
    """The measurement of an experiment that was kept; `channels`: what input and output of its plant are."""
    point = tuple(experiment.held_at)
    if experiment.kind == "timeRecord":
        assert experiment.sample_time_seconds is not None, "time records have a sample time"
        period = experiment.understood.period_samples
        record = TimeRecord(arrays["input"], arrays["output"], experiment.sample_time_seconds, point, period)
        return under(experiment, record, channels, arrays.get("reference"))
    return FrequencyResponse(
        arrays["frequenciesRadPerSecond"],
        arrays["response"],
        point,
        experiment.sample_time_seconds,
        arrays.get("variance"),
        experiment.variance_degrees_of_freedom,
        channels=channels,
    )


def quantities_by_name(quantities: Sequence[LoggedQuantity]) -> dict[str, float]:
    """Logged quantities by name and unit, such as temperature [K]: other units are another quantity."""
    return {f"{one.name} [{one.unit}]" if one.unit else one.name: one.value for one in quantities}


def logged_values(experiment: Experiment) -> dict[str, float]:
    """The logged quantities of an experiment by name and unit."""
    return quantities_by_name(experiment.logged_quantities)


def kept_batches(
    given: Sequence[Mapping[str, Any]], arrays: ArrayStore, mean_value: bool, channels: Channels
) -> tuple[Batch, ...]:
    """The experiments in a payload with their logged quantities, ready to be compared with a model."""
    logged = [logged_values(Experiment.model_validate(one["document"])) for one in given]
    return gather(kept_measurements(given, arrays, channels), mean_value, logged)


def held_out_batches(
    given: Sequence[Mapping[str, Any]], arrays: ArrayStore, mean_value: bool, model: Model, channels: Channels
) -> tuple[Batch, ...]:
    """The held-out experiments in a payload, if any; raises MisuseError when they do not match the model."""
    with field_named({}, "/heldOutExperimentIds"), within_doubles():
        held_out = kept_batches(given, arrays, mean_value, channels) if given else ()
        require_matching(model, held_out)
    return held_out


def kept_measurements(given: Sequence[Mapping[str, Any]], arrays: ArrayStore, channels: Channels) -> list[Measurement]:
    """The measurements of the experiments in a payload, {"document": …, "arrays": hash} each."""
    documents = [Experiment.model_validate(one["document"]) for one in given]
    return [
        kept_measurement(document, arrays.get(one["arrays"]), channels)
        for document, one in zip(documents, given, strict=True)
    ]
