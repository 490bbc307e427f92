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
from app.files.contents import FileError
from app.files.measurement import Reading, Statements, measurement_arrays, read_measurements
from app.files.statements import Signal
from app.files.varying_record import VaryingReading, VaryingStatements, read_varying
from app.jobs.outcomes import Made
from app.jobs.task import TaskContext, TaskResult
from app.schemas.conditions import RecordConditions
from app.schemas.experiments import FileFields
from app.schemas.plants import Plant
from app.store.identifiers import new_identifier
from identification.signals import FrequencyResponse, Measurement, TimeRecord

KIND = "experiment"
SIGNALS = {"input": "/inputs", "output": "/outputs", "scheduling": "/scheduling"}
CONDITIONS = {"inputLevel", "outputLevel", "inputHold", "feedback"}
KEPT = {
    *("plantId", "name", "description", "operatingPoint", "designId", "loggedQuantities", "columns", "units"),
    *CONDITIONS,
}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Read the measurement, inspect it, keep its arrays; of a table with several operating points, each of them."""
    context.progress(0.1, "reading")
    arrays = context.arrays.get(payload["arrays"])
    if payload.get("plant") is not None:
        return _along(payload, arrays, context)
    if payload["source"] == "json":
        readings = [Reading(_from_body(payload["stated"], arrays))]
    else:
        readings = _from_file(payload, FileFields.model_validate(payload["stated"]), arrays["file"].tobytes())
    context.progress(0.5, "looking at the data")
    first, *others = (_looked_at(one, payload, context, len(readings) > 1) for one in readings)
    beside = [
        Made("experiments", new_identifier(), payload["stated"]["plantId"], one.document, one.arrays) for one in others
    ]
    document = {**first.document, "siblingIds": [one.identifier for one in beside]} if beside else first.document
    return TaskResult(document, first.arrays, tuple(beside))


def _looked_at(reading: Reading, payload: dict[str, Any], context: TaskContext, several: bool) -> TaskResult:
    data, stated = reading.measurement, payload["stated"]
    with within_doubles():
        understood = understanding(data)
    understood.warnings[:0] = reading.notes
    kept = payload["arrays"] if payload["source"] == "json" else context.arrays.put(measurement_arrays(data))
    point = ", ".join(f"{value:g}" for value in data.operating_point)
    document = {
        **{name: value for name, value in stated.items() if name in KEPT},
        "name": f"{stated.get('name', '')} at {point}".strip() if several else stated.get("name", ""),
        "operatingPoint": list(data.operating_point),
        "softwareVersion": __version__,
        "kind": kind_of(data),
        "sampleTimeSeconds": data.sample_time,
        "varianceKnown": isinstance(data, FrequencyResponse) and data.variance is not None,
        "varianceDegreesOfFreedom": data.variance_degrees_of_freedom if isinstance(data, FrequencyResponse) else None,
        "source": payload["source"],
        "fileName": payload["fileName"],
        "understood": understood.as_json(),
    }
    if isinstance(data, TimeRecord) and data.feedback:
        document["feedback"] = True
    return TaskResult(document, kept)


def _along(payload: dict[str, Any], arrays: dict[str, Any], context: TaskContext) -> TaskResult:
    """A record in which the scheduling varied."""
    plant, stated = Plant.model_validate(payload["plant"]), payload["stated"]
    if payload["source"] == "json":
        variables = scheduling_variables(plant)
        data = varying_record(arrays, stated["sampleTimeSeconds"], stated["periodSamples"], variables)
        notes: tuple[str, ...] = ()
    else:
        read = _varying_from_file(payload, FileFields.model_validate(stated), arrays["file"].tobytes(), plant)
        data, notes = read.record, read.notes
    context.progress(0.5, "looking at the data")
    with within_doubles(), field_named(SIGNALS if payload["source"] == "json" else {}, "/file"):
        understood = varying_understanding(data)
    understood.warnings[:0] = notes
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


def _varying_from_file(payload: dict[str, Any], stated: FileFields, content: bytes, plant: Plant) -> VaryingReading:
    inputs, outputs = _signals(payload)
    given = VaryingStatements(
        scheduling_variables(plant),
        stated.sample_time_seconds,
        stated.period_samples,
        stated.variable_group,
        None if stated.scheduling_columns is None else tuple(stated.scheduling_columns),
        tuple(stated.columns),
        tuple(stated.units),
        tuple(stated.rows),
        inputs,
        outputs,
    )
    fields = dict.fromkeys(("input", "output", "scheduling"), "/file")
    with field_named({**fields, "period": "/periodSamples", "sample_time": "/sampleTimeSeconds"}):
        read = read_varying(content, payload["source"], given)
        require_varying_channels(read.record, channels(plant))
    return read


def _signals(payload: dict[str, Any]) -> tuple[tuple[Signal, ...], tuple[Signal, ...]]:
    """The plant's inputs and outputs; without names where a job was queued before they were handed on."""
    given = payload.get("signals", {"inputs": [{}], "outputs": [{}]})
    inputs, outputs = (
        tuple(Signal(one.get("name", ""), one.get("unit", "")) for one in given[which])
        for which in ("inputs", "outputs")
    )
    return inputs, outputs


def _from_body(stated: dict[str, Any], arrays: dict[str, Any]) -> Measurement:
    point = tuple(stated["operatingPoint"])
    if stated["kind"] == "timeRecord":
        period = stated["periodSamples"]
        record = TimeRecord(arrays["input"], arrays["output"], stated["sampleTimeSeconds"], point, period)
        conditions = RecordConditions.model_validate({one: stated[one] for one in CONDITIONS & set(stated)})
        return under(conditions, record, reference=arrays.get("reference"))
    return FrequencyResponse(
        arrays["frequenciesRadPerSecond"],
        arrays["response"],
        point,
        stated["sampleTimeSeconds"],
        arrays.get("variance"),
        stated["varianceDegreesOfFreedom"],
    )


def _from_file(payload: dict[str, Any], stated: FileFields, content: bytes) -> list[Reading]:
    expected = tuple(payload.get("channels", (1, 1)))
    inputs, outputs = _signals(payload)
    variables = payload.get("signals", {}).get("variables", [])
    given = Statements(
        tuple(stated.operating_point or ()),
        stated.sample_time_seconds,
        stated.period_samples,
        stated.variable_group,
        expected,
        tuple(stated.columns),
        tuple(stated.units),
        tuple(stated.rows),
        stated.averages,
        inputs,
        outputs,
        tuple(one["name"] for one in variables),
        None if stated.operating_point_columns is None else tuple(stated.operating_point_columns),
    )
    found = []
    for one in read_measurements(content, payload["source"], given):
        data = plainest(one.measurement) if isinstance(one.measurement, FrequencyResponse) else one.measurement
        _require_in_range(data.operating_point, variables)
        with field_named({"output": "/file", "response": "/file", "record_conditions": "/file"}):
            require_channels(data, expected)
            found.append(Reading(under(stated, data), one.notes))
    return found


def _require_in_range(point: tuple[float, ...], variables: list[dict[str, Any]]) -> None:
    for value, variable in zip(point, variables, strict=False):
        if not variable["minimum"] <= value <= variable["maximum"]:
            raise FileError(
                f"the file has {variable['name']} = {value:g}, outside the plant's range from {variable['minimum']:g}"
                f" to {variable['maximum']:g}; choose lines with rows, or widen the range",
                "/operatingPointColumns",
            )
