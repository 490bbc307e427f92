"""Makes out what was measured."""

from typing import Any

from app import __version__
from app.conversion.experiments import kind_of, plainest, require_channels, under
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.inspection import understanding
from app.conversion.plants import channels, scheduling_variables
from app.conversion.varying_records import (
    record_arrays,
    require_varying_channels,
    varying_record,
    varying_understanding,
)
from app.files.measurement import Statements, measurement_arrays, read_measurement
from app.files.varying_record import VaryingStatements, read_varying
from app.jobs.task import TaskContext, TaskResult
from app.schemas.conditions import RecordConditions
from app.schemas.experiments import FileFields
from app.schemas.plants import Plant
from identification.signals import FrequencyResponse, Measurement, TimeRecord
from identification.varying.records import VaryingRecord

KIND = "experiment"
SIGNALS = {"input": "/inputs", "output": "/outputs", "scheduling": "/scheduling"}
CONDITIONS = {"inputLevel", "outputLevel", "inputHold", "feedback"}
KEPT = {"plantId", "name", "description", "operatingPoint", "designId", "loggedQuantities", *CONDITIONS}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Read the measurement, inspect it, keep its arrays."""
    context.progress(0.1, "reading")
    arrays = context.arrays.get(payload["arrays"])
    stated = payload["stated"]
    if payload.get("plant") is not None:
        return _along(payload, arrays, context)
    if payload["source"] == "json":
        data = _from_body(stated, arrays)
    else:
        content = arrays["file"].tobytes()
        data = _from_file(
            payload["source"], FileFields.model_validate(stated), content, tuple(payload.get("channels", (1, 1)))
        )
    context.progress(0.5, "looking at the data")
    with within_doubles():
        understood = understanding(data)
    kept = payload["arrays"] if payload["source"] == "json" else context.arrays.put(measurement_arrays(data))
    document = {
        **{name: value for name, value in stated.items() if name in KEPT},
        "softwareVersion": __version__,
        "kind": kind_of(data),
        "sampleTimeSeconds": data.sample_time,
        "varianceKnown": isinstance(data, FrequencyResponse) and data.variance is not None,
        "varianceDegreesOfFreedom": data.variance_degrees_of_freedom if isinstance(data, FrequencyResponse) else None,
        "source": payload["source"],
        "fileName": payload["fileName"],
        "understood": understood.as_json(),
    }
    return TaskResult(document, kept)


def _along(payload: dict[str, Any], arrays: dict[str, Any], context: TaskContext) -> TaskResult:
    """A record in which the scheduling varied."""
    plant, stated = Plant.model_validate(payload["plant"]), payload["stated"]
    if payload["source"] == "json":
        variables = scheduling_variables(plant)
        data = varying_record(arrays, stated["sampleTimeSeconds"], stated["periodSamples"], variables)
    else:
        data = _varying_from_file(payload["source"], FileFields.model_validate(stated), arrays["file"].tobytes(), plant)
    context.progress(0.5, "looking at the data")
    with within_doubles(), field_named(SIGNALS if payload["source"] == "json" else {}, "/file"):
        understood = varying_understanding(data)
    document = {
        **{name: value for name, value in stated.items() if name in KEPT},
        "operatingPoint": None,
        "softwareVersion": __version__,
        "kind": "varyingRecord",
        "sampleTimeSeconds": data.sample_time,
        "varianceKnown": False,
        "varianceDegreesOfFreedom": None,
        "source": payload["source"],
        "fileName": payload["fileName"],
        "understood": understood.as_json(),
    }
    return TaskResult(document, context.arrays.put(record_arrays(data)))


def _varying_from_file(source: str, stated: FileFields, content: bytes, plant: Plant) -> VaryingRecord:
    columns = None if stated.scheduling_columns is None else tuple(stated.scheduling_columns)
    given = VaryingStatements(
        scheduling_variables(plant),
        stated.sample_time_seconds,
        stated.period_samples,
        stated.variable_group,
        columns,
        tuple(stated.columns),
    )
    fields = dict.fromkeys(("input", "output", "scheduling"), "/file")
    with field_named({**fields, "period": "/periodSamples", "sample_time": "/sampleTimeSeconds"}):
        data = read_varying(content, source, given)
        require_varying_channels(data, channels(plant))
    return data


def _from_body(stated: dict[str, Any], arrays: dict[str, Any]) -> Measurement:
    point = tuple(stated["operatingPoint"])
    if stated["kind"] == "timeRecord":
        period = stated["periodSamples"]
        record = TimeRecord(arrays["input"], arrays["output"], stated["sampleTimeSeconds"], point, period)
        return under(RecordConditions.model_validate({one: stated[one] for one in CONDITIONS & set(stated)}), record)
    return FrequencyResponse(
        arrays["frequenciesRadPerSecond"],
        arrays["response"],
        point,
        stated["sampleTimeSeconds"],
        arrays.get("variance"),
        stated["varianceDegreesOfFreedom"],
    )


def _from_file(source: str, stated: FileFields, content: bytes, channels: tuple[int, int]) -> Measurement:
    data = read_measurement(
        content,
        source,
        Statements(
            tuple(stated.operating_point or ()),
            stated.sample_time_seconds,
            stated.period_samples,
            stated.variable_group,
            channels,
            tuple(stated.columns),
        ),
    )
    if isinstance(data, FrequencyResponse):
        data = plainest(data)
    with field_named({"output": "/file", "response": "/file", "record_conditions": "/file"}):
        require_channels(data, channels)
        return under(stated, data)
