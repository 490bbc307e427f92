"""Simulates one period of the steady output of a model at operating points held still."""

from typing import Any

import numpy as np

from app import __version__
from app.conversion.effects import extended_model
from app.conversion.experiments import kept_measurement
from app.conversion.extremes import finite, within_doubles
from app.conversion.fields import field_named
from app.conversion.simulations import left_out_documents, output_documents, range_documents, steady_notes
from app.jobs.task import TaskContext, TaskResult
from app.schemas.experiments import Experiment
from app.schemas.models import Model as ModelDocument
from app.schemas.plants import Plant
from identification.along import Simulation
from identification.arrays import FloatArray
from identification.comparison.gather import gather
from identification.errors import MisuseError
from identification.extension.steady_period import SteadyPeriod, steady_period
from identification.models.model import Model

KIND = "steady_simulation"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The output and its standard deviation, one operating point after the other."""
    plant, model = Plant.model_validate(payload["plant"]), ModelDocument.model_validate(payload["model"])
    points = np.array(payload["operatingPoints"])
    known = (model.joint_covariance if model.effects else model.covariance) is not None
    with field_named(payload["pointers"], "/excitation"), within_doubles():
        u = _input(payload, context)
        found = _simulated(extended_model(model, plant), payload, u, known, context)
        output = finite(np.concatenate([one.output for one in found]).T, "outputs")
        parts = [one.deviation for one in found if one.deviation is not None]
        deviation = finite(np.concatenate(parts).T, "deviations") if len(parts) == len(points) else None
    kept = {"input": u[:, None], "output": output, "operatingPoints": points}
    kept["scheduling"] = np.tile(points[0], (len(u), 1)) if len(points) == 1 else np.zeros((len(u), 0))
    if deviation is not None:
        kept["deviation"] = deviation
    document = {
        **payload["stated"],
        "softwareVersion": __version__,
        "modelId": model.id,
        "kind": "steadyPeriod",
        "samples": len(u),
        "ranges": [one.as_json() for one in range_documents(plant, points)],
        "outputs": [one.as_json() for one in output_documents(Simulation(output, deviation), points)],
        "leftOutEffects": [one.as_json() for one in left_out_documents(found[0].left_out)],
        "notes": steady_notes(model, payload["loggedQuantities"], known, deviation is not None),
    }
    return TaskResult(document, context.arrays.put(kept))


def _input(payload: dict[str, Any], context: TaskContext) -> FloatArray:
    """One period: as stated, or the mean of the steady periods of a record."""
    arrays = context.arrays.get(payload["arrays"])
    if payload["experiment"] is None:
        return np.asarray(arrays["input"], dtype=np.float64)
    (batch,) = gather([kept_measurement(Experiment.model_validate(payload["experiment"]), arrays)])
    if batch.signals is None:
        raise MisuseError("the record has not two whole periods; name another, or state one period", "input")
    return np.asarray(batch.signals[0])


def _simulated(
    model: Model, payload: dict[str, Any], u: FloatArray, known: bool, context: TaskContext
) -> list[SteadyPeriod]:
    points, sample_time = payload["operatingPoints"], model.structure.sample_time
    found = []
    for i, point in enumerate(points):
        context.progress(0.1 + 0.8 * i / len(points), f"operating point {i + 1} of {len(points)}")
        given = sample_time or payload["sampleTimeSeconds"]
        found.append(steady_period(model, u, given, [point], payload["loggedQuantities"], known))
    return found
