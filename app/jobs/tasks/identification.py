"""Identifies a parameter-varying model from experiments."""

import dataclasses
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
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
from identification.errors import MisuseError
from identification.estimates import LocalEstimate, LpvEstimate
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, Measurement, TimeRecord

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
    data = [_fitted_data(request, structure, i, record, context) for i, record in enumerate(measured)]
    with field_named(FIELDS, "/experimentIds"), within_doubles():
        local = _local_estimates(request, structure, data, context)
        context.progress(0.8, "the parameter-varying model")
        estimate: LpvEstimate = request.lpv_estimator.build().estimate(
            structure, dependence, data, local, prior=prior and kept_model(prior, plant)
        )
        require_finite(estimate.model)
    estimate = _with_output_noise(estimate, experiments, measured, data)
    return TaskResult(_document(plant, request, estimate, experiments, data, local))


def _fitted_data(
    request: ModelRequest, structure: RationalStructure, index: int, record: Measurement, context: TaskContext
) -> Measurement:
    """The record itself, or its frequency response when the local estimator takes those."""
    if not isinstance(record, TimeRecord) or request.local_estimator.build().data is TimeRecord:
        return record
    context.progress(0.05, f"the frequency response of experiment {index + 1}")
    assert request.spectral_estimator is not None, "checked when the job was submitted"
    with within_doubles(), _place_named(index, record):
        response: FrequencyResponse = request.spectral_estimator.build().estimate(record)
    return response if structure.is_discrete else dataclasses.replace(response, sample_time=None)


def _with_output_noise(
    estimate: LpvEstimate,
    experiments: Sequence[Experiment],
    measured: Sequence[Measurement],
    data: Sequence[Measurement],
) -> LpvEstimate:
    """The noise variance of the output in its unit, as designs need it, where responses of records were fitted.

    Fits of responses give it as a factor on the variances of the responses only.
    """
    levels = [experiment.understood.noise_level for experiment in experiments]
    known = [level for level in levels if level is not None and level > 0]
    records = all(isinstance(one, TimeRecord) for one in measured)
    if not records or len(known) < len(levels) or any(isinstance(one, TimeRecord) for one in data):
        return estimate
    variance = sum(level**2 for level in known) / len(known)
    return dataclasses.replace(estimate, model=dataclasses.replace(estimate.model, noise_variance=variance))


def _local_estimates(
    request: ModelRequest, structure: RationalStructure, data: Sequence[Measurement], context: TaskContext
) -> tuple[LocalEstimate, ...]:
    estimator = request.local_estimator.build()
    estimates = []
    for i, measurement in enumerate(data):
        context.progress(0.1 + 0.7 * i / len(data), f"local model {i + 1} of {len(data)}")
        with _place_named(i, measurement):
            estimates.append(estimator.estimate(structure, measurement))
    return tuple(estimates)


@contextmanager
def _place_named(index: int, measurement: Measurement) -> Iterator[None]:
    """Misuse of one experiment is named by its place in the request and its operating point."""
    try:
        yield
    except MisuseError as error:
        where = ", ".join(f"{value:g}" for value in measurement.operating_point)
        raise MisuseError(f"the experiment at {where}: {error}", f"/experimentIds/{index}") from error


def _document(
    plant: Plant,
    request: ModelRequest,
    estimate: LpvEstimate,
    experiments: Sequence[Experiment],
    data: Sequence[Measurement],
    local: Sequence[LocalEstimate],
) -> dict[str, Any]:
    model = estimate.model
    designs = {experiment.design_id for experiment in experiments}
    asked = request.as_json()
    structure, basis, own_bases = chosen(plant, request)
    over_range = range_documents(model)
    locals_ = zip(local, data, experiments, strict=True)
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
