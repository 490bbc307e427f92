"""Makes out what was measured."""

from typing import Any

from app import __version__
from app.conversion.experiments import kind_of, plainest, require_channels
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.inspection import understanding
from app.files.measurement import Statements, measurement_arrays, read_measurement
from app.jobs.task import TaskContext, TaskResult
from app.schemas.experiments import FileFields
from identification.signals import FrequencyResponse, Measurement, TimeRecord

KIND = "experiment"
KEPT = {"plantId", "name", "description", "operatingPoint", "designId"}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Read the measurement, inspect it, keep its arrays."""
    context.progress(0.1, "reading")
    arrays = context.arrays.get(payload["arrays"])
    stated = payload["stated"]
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


def _from_body(stated: dict[str, Any], arrays: dict[str, Any]) -> Measurement:
    point = tuple(stated["operatingPoint"])
    if stated["kind"] == "timeRecord":
        period = stated["periodSamples"]
        return TimeRecord(arrays["input"], arrays["output"], stated["sampleTimeSeconds"], point, period)
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
            tuple(stated.operating_point),
            stated.sample_time_seconds,
            stated.period_samples,
            stated.variable_group,
            channels,
        ),
    )
    if isinstance(data, FrequencyResponse):
        data = plainest(data)
    with field_named({"output": "/file", "response": "/file"}):
        require_channels(data, channels)
    return data
