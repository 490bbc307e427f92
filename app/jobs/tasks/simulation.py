"""Simulates a model along p(t)."""

from typing import Any

import numpy as np

from app import __version__
from app.conversion.extremes import finite, within_doubles
from app.conversion.fields import field_named
from app.conversion.simulations import output_documents, range_documents, simulated
from app.jobs.task import TaskContext, TaskResult
from app.schemas.models import Model
from app.schemas.plants import Plant

KIND = "simulation"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The output and its standard deviation."""
    plant, model = Plant.model_validate(payload["plant"]), Model.model_validate(payload["model"])
    arrays = context.arrays.get(payload["arrays"])
    pointers = payload["pointers"]
    context.progress(0.1, "simulating")
    with field_named(pointers, pointers["scheduling"]), within_doubles():
        found, notes = simulated(model, plant, arrays["input"], arrays["scheduling"])
        output = finite(found.output, "outputs")
    kept = {"input": arrays["input"], "scheduling": arrays["scheduling"], "output": output}
    if found.deviation is not None:
        kept["deviation"] = finite(found.deviation, "deviations")
    document = {
        **payload["stated"],
        "softwareVersion": __version__,
        "modelId": model.id,
        "samples": len(output),
        "ranges": [one.as_json() for one in range_documents(plant, np.asarray(arrays["scheduling"]))],
        "outputs": [one.as_json() for one in output_documents(found)],
        "notes": notes,
    }
    return TaskResult(document, context.arrays.put(kept))
