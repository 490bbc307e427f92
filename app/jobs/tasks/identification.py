"""Identifies a parameter-varying model from experiments."""

from collections.abc import Sequence
from typing import Any

from app import __version__
from app.conversion.experiments import kept_measurement
from app.conversion.extremes import require_finite, within_doubles
from app.conversion.fields import field_named
from app.conversion.models import (
    accuracy_documents,
    chosen,
    kept_model,
    local_document,
    outcome_document,
    range_documents,
    requested_structure,
    test_documents,
)
from app.jobs.task import TaskContext, TaskResult
from app.schemas.experiments import Experiment
from app.schemas.models import Model, ModelRequest
from app.schemas.plants import Plant
from identification.estimates import Estimate
from identification.methods.method import Task
from identification.methods.two_step import TwoStep

KIND = "identification"
FIELDS = {"operating_points": "/experimentIds", "experiments": "/experimentIds", "prior": "/priorModelId"}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Spectral estimates where they are needed, local estimates, then the parameter-varying one."""
    plant = Plant.model_validate(payload["plant"])
    request = ModelRequest.model_validate(payload["request"])
    prior = payload["prior"] and Model.model_validate(payload["prior"])
    experiments = [Experiment.model_validate(given["document"]) for given in payload["experiments"]]
    with field_named({}, "/structure"):
        structure, dependence = requested_structure(plant, request)
    measured = [
        kept_measurement(experiment, context.arrays.get(given["arrays"]))
        for experiment, given in zip(experiments, payload["experiments"], strict=True)
    ]
    spectral = None if request.spectral_estimator is None else request.spectral_estimator.build()
    way = TwoStep(spectral, request.local_estimator.build(), request.lpv_estimator.build())
    places = {f"data[{i}]": f"/experimentIds/{i}" for i in range(len(measured))}
    with field_named({**FIELDS, **places}, "/experimentIds"), within_doubles():
        known = kept_model(prior, plant) if prior else None
        estimate = way.estimate(Task(tuple(measured), structure, dependence, prior=known), context.progress)
        require_finite(estimate.model)
    return TaskResult(_document(plant, request, estimate, experiments))


def _document(
    plant: Plant,
    request: ModelRequest,
    estimate: Estimate,
    experiments: Sequence[Experiment],
) -> dict[str, Any]:
    model = estimate.model
    designs = {experiment.design_id for experiment in experiments}
    asked = request.as_json()
    structure, basis, own_bases = chosen(plant, request)
    over_range = range_documents(model)
    locals_ = zip(estimate.local, estimate.fitted, experiments, strict=True)
    return {
        **{
            name: asked[name] for name in ("name", "description", "localEstimator", "lpvEstimator", "spectralEstimator")
        },
        "softwareVersion": __version__,
        "origin": "identified",
        "structure": structure.as_json(),
        "basis": basis.as_json(),
        "coefficientBases": [basis.as_json() for basis in own_bases],
        "coefficientNames": list(model.structure.coefficient_names),
        "parameterNames": list(model.parameter_names),
        **accuracy_documents(model),
        "outcome": outcome_document(estimate.outcome).as_json(),
        "tests": [test.as_json() for test in test_documents(estimate.tests)],
        "localModels": [local_document(one, fitted, e.id).as_json() for one, fitted, e in locals_],
        "stable": over_range["stable"],
        "poles": [poles.as_json() for poles in over_range["poles"]],
        "experimentIds": list(request.experiment_ids),
        "designId": designs.pop() if len(designs) == 1 else None,
        "parentId": request.prior_model_id,
        "seed": None,
    }
