"""Holds a model against experiments, fitted ones and held-out ones apart."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app import __version__
from app.conversion.channels import channels_of
from app.conversion.comparisons import compared_experiments, map_arrays, part_document
from app.conversion.effects import extended_model
from app.conversion.experiments import kept_batches
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.varying_comparisons import (
    noise_of,
    period_options,
    varying_arrays,
    varying_compared,
    varying_part,
)
from app.conversion.varying_models import kept_varying
from app.conversion.varying_records import kept_record
from app.jobs.task import TaskContext, TaskResult
from app.schemas.comparisons import ComparedExperiment, Data
from app.schemas.experiments import Experiment
from app.schemas.models import Model
from app.schemas.plants import Plant
from identification.comparison.batch import Batch
from identification.comparison.compare import Comparison, compare
from identification.varying.comparison import VaryingComparison, compare_varying

KIND = "comparison"
FIELDS = {"model": "/modelId", "effects": "/modelId"}
PARTS: tuple[Data, ...] = ("fitted", "heldOut")


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The tests and maps of each part of the data."""
    experiments = [Experiment.model_validate(given["document"]) for given in payload["experiments"]]
    still = [i for i, one in enumerate(experiments) if one.operating_point is not None]
    arrays: dict[str, NDArray[Any]] = {"operatingPoints": np.array([experiments[i].held_at for i in still])}
    parts: list[dict[str, Any]] = []
    compared: dict[int, ComparedExperiment] = {}
    for data in PARTS:
        places = [i for i in still if payload["data"][i] == data]
        if not places:
            continue
        context.progress(0.1 + 0.4 * PARTS.index(data), "the fitted data" if data == "fitted" else "held-out data")
        found, batches = _compared(payload, data, places, context)
        measured = [experiments[i] for i in places]
        parts.append(part_document(data, found, batches, measured).as_json())
        documents = compared_experiments(data, found, measured)
        compared |= dict(zip(places, documents, strict=True))
        arrays |= map_arrays(found, places)
    for i in sorted(set(range(len(experiments))) - set(still)):
        context.progress(0.9, f"the record along varying scheduling, experiment {i + 1}")
        along = _along(payload, i, experiments[i], context)
        parts.append(varying_part(payload["data"][i], experiments[i].id, along).as_json())
        compared[i] = varying_compared(payload["data"][i], experiments[i].id, along)
        arrays |= {**varying_arrays(along, i), f"sampleTimeSeconds{i}": np.array(experiments[i].sample_time_seconds)}
    document = {
        **{name: payload["request"][name] for name in ("name", "description", "modelId", "meanValue")},
        "softwareVersion": __version__,
        "experiments": [compared[i].as_json() for i in range(len(experiments))],
        "parts": parts,
    }
    return TaskResult(document, context.arrays.put(arrays))


def _along(payload: dict[str, Any], place: int, experiment: Experiment, context: TaskContext) -> VaryingComparison:
    """The comparison with one record in which the scheduling varied."""
    model, plant = Model.model_validate(payload["model"]), Plant.model_validate(payload["plant"])
    fields = {"record": f"/experimentIds/{place}", "sample_time": f"/experimentIds/{place}"}
    with field_named({**FIELDS, **fields}, f"/experimentIds/{place}"), within_doubles():
        record = kept_record(experiment, plant, context.arrays.get(payload["experiments"][place]["arrays"]))
        fitted = payload["data"][place] == "fitted"
        return compare_varying(kept_varying(model, plant), record, fitted, noise_of(model), **period_options(model))


def _compared(
    payload: dict[str, Any], data: Data, places: list[int], context: TaskContext
) -> tuple[Comparison, tuple[Batch, ...]]:
    plant = Plant.model_validate(payload["plant"])
    model = extended_model(Model.model_validate(payload["model"]), plant)
    with field_named(FIELDS, "/experimentIds"), within_doubles():
        given = [payload["experiments"][i] for i in places]
        batches = kept_batches(given, context.arrays, payload["request"]["meanValue"], channels_of(plant))
        return compare(model, batches, fitted=data == "fitted"), batches
