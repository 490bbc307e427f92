"""Looks into a file of measurements."""

from typing import Any

import numpy as np

from app import __version__
from app.arrays import finite_or_none
from app.conversion.experiments import kind_of
from app.files.measurement import Statements
from app.files.preview import Preview, names_all, preview
from app.files.statements import Signal
from app.jobs.task import TaskContext, TaskResult
from app.json_pointer import field_pointer
from app.schemas.experiments import FileFields
from identification.errors import MisuseError
from identification.signals import TimeRecord

KIND = "preview"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Columns with their first rows, what each is taken for, and a small picture; or what is to be said first."""
    context.progress(0.1, "reading")
    content = context.arrays.get(payload["arrays"])["file"].tobytes()
    stated = FileFields.model_validate(payload["stated"])
    columns, units, remembered = _statements(stated, payload, content)
    signals = payload["signals"]
    given = Statements(
        tuple(stated.operating_point or (0.0,) * len(signals["variables"])),
        stated.sample_time_seconds,
        stated.period_samples,
        stated.variable_group,
        tuple(payload["channels"]),
        tuple(columns),
        tuple(units),
        tuple(stated.rows),
        stated.averages,
        tuple(Signal(one["name"], one.get("unit", "")) for one in signals["inputs"]),
        tuple(Signal(one["name"], one.get("unit", "")) for one in signals["outputs"]),
        tuple(one["name"] for one in signals["variables"]) if stated.operating_point else (),
    )
    seen = preview(content, payload["source"], given)
    return TaskResult(
        {
            "softwareVersion": __version__,
            "plantId": stated.plant_id,
            "source": payload["source"],
            "fileName": payload["fileName"],
            "statedColumns": columns,
            "statedUnits": units,
            "remembered": remembered,
            **_seen(seen),
        }
    )


def _statements(stated: FileFields, payload: dict[str, Any], content: bytes) -> tuple[list[str], list[str], bool]:
    """What was stated of the columns, or what is remembered where nothing was and the file has the same ones."""
    before = payload["remembered"]
    names = [one.partition("=")[2] for one in before["columns"]] + [one.rpartition("=")[0] for one in before["units"]]
    if stated.columns or stated.units or not names:
        return list(stated.columns), list(stated.units), False
    if not names_all(content, payload["source"], stated.variable_group, names):
        return [], [], False
    return before["columns"], before["units"], True


def _seen(seen: Preview) -> dict[str, Any]:
    data = None if seen.reading is None else seen.reading.measurement
    return {
        "tables": list(seen.tables),
        "variableGroup": seen.table,
        "columns": [
            {
                "name": one.name,
                "unit": one.unit,
                "takenFor": one.role,
                "sign": one.sign,
                "firstValues": list(one.values),
                "count": one.count,
            }
            for one in seen.columns
        ],
        "kind": None if data is None else kind_of(data),
        "sampleTimeSeconds": data.sample_time if data is not None else None,
        "warnings": [] if seen.reading is None else list(seen.reading.notes),
        "problem": None if seen.problem is None else _problem(seen.problem),
        "picture": None if data is None else _picture(seen, isinstance(data, TimeRecord)),
    }


def _problem(error: MisuseError) -> dict[str, str]:
    pointer = "/file" if error.field is None else field_pointer(error.field)
    return {"pointer": pointer, "detail": str(error), "location": "body"}


def _picture(seen: Preview, record: bool) -> dict[str, Any]:
    assert seen.picture is not None, "what was understood is drawn"
    return {
        "abscissa": "timeSeconds" if record else "frequenciesRadPerSecond",
        "values": seen.picture.abscissa.tolist(),
        "curves": [
            {"name": name, "values": [finite_or_none(float(value)) for value in np.asarray(values)]}
            for name, values in seen.picture.curves
        ],
    }
