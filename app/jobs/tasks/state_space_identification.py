"""Identifies state-space models from frequency responses: at single operating points, over the range, or both."""

import dataclasses
from collections.abc import Sequence
from typing import Any

from pydantic.alias_generators import to_camel

from app import __version__
from app.conversion.experiments import kept_measurement
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.models import chosen
from app.conversion.parametric import Found, model_documents, refined_guarantee, state_space_result
from app.conversion.plants import sample_time
from app.conversion.state_space import requested_state_space
from app.jobs.task import TaskContext, TaskResult
from app.schemas.experiments import Experiment
from app.schemas.plants import Plant
from app.schemas.plug_ins import PlugInDocument
from app.schemas.state_space import StateSpaceModelRequest
from identification.errors import MisuseError
from identification.estimates import Estimate
from identification.parametric.estimate import ParametricEstimate
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse, Measurement
from identification.subspace.result import SubspaceEstimate

KIND = "state_space_identification"
OF_DATA = ("frequencies", "response", "variance", "covariance", "experiments", "operating_points")


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Spectral estimates where they are needed, models of the operating points, then the parameter-varying one."""
    plant = Plant.model_validate(payload["plant"])
    request = StateSpaceModelRequest.model_validate(payload["request"])
    experiments = [Experiment.model_validate(given["document"]) for given in payload["experiments"]]
    with field_named({}, "/structure"):
        structure, dependence = requested_state_space(plant, request)
    measured = [
        kept_measurement(experiment, context.arrays.get(given["arrays"]))
        for experiment, given in zip(experiments, payload["experiments"], strict=True)
    ]
    continuous = sample_time(structure) is None
    data = [_response(request, continuous, i, record, context) for i, record in enumerate(measured)]
    with within_doubles():
        local = _local(request, structure.order, data, context)
        found = _parametric(request, structure.order, dependence, data, context)
        refined = None if found is None else _refined(request, found, data, context)
        result = Found(data, [experiment.id for experiment in experiments], local, found, refined)
        return TaskResult(_document(plant, request, experiments, result))


def _response(
    request: StateSpaceModelRequest, continuous: bool, index: int, record: Measurement, context: TaskContext
) -> FrequencyResponse:
    """The frequency response itself, or that of a time record."""
    if isinstance(record, FrequencyResponse):
        return record
    context.progress(0.05, f"the frequency response of experiment {index + 1}")
    assert request.spectral_estimator is not None, "checked when the job was submitted"
    with field_named({}, f"/experimentIds/{index}"), within_doubles():
        response: FrequencyResponse = request.spectral_estimator.build().estimate(record)
    return dataclasses.replace(response, sample_time=None) if continuous else response


def _local(
    request: StateSpaceModelRequest, order: int | None, data: Sequence[FrequencyResponse], context: TaskContext
) -> list[SubspaceEstimate]:
    if request.subspace_estimator is None:
        return []
    asked, estimates = request.subspace_estimator, []
    estimator = asked.build(order=order)
    for i, response in enumerate(data):
        context.progress(0.1 + 0.3 * i / len(data), f"operating point {i + 1} of {len(data)}")
        try:
            with field_named(_fields(asked, "/subspaceEstimator", f"/experimentIds/{i}"), f"/experimentIds/{i}"):
                estimates.append(estimator.estimate(response))
        except MisuseError as error:
            where = ", ".join(f"{value:g}" for value in response.operating_point)
            raise MisuseError(f"the experiment at {where}: {error}", error.field) from error
    return estimates


def _parametric(
    request: StateSpaceModelRequest,
    order: int | None,
    dependence: ParameterDependence,
    data: Sequence[FrequencyResponse],
    context: TaskContext,
) -> ParametricEstimate | None:
    if request.parametric_estimator is None:
        return None
    context.progress(0.4, "the parameter-varying model")
    asked = request.parametric_estimator
    with field_named(_fields(asked, "/parametricEstimator", "/experimentIds"), "/experimentIds"):
        found: ParametricEstimate = asked.build(order=order).estimate(dependence, data)
    return found


def _refined(
    request: StateSpaceModelRequest,
    found: ParametricEstimate,
    data: Sequence[FrequencyResponse],
    context: TaskContext,
) -> Estimate | None:
    """The refined estimate; None where none is asked for, or where the model found is no start for one."""
    if request.refinement is None or not found.outcome.ok:
        return None
    context.progress(0.6, "refinement")
    fields = _fields(request.refinement, "/refinement", "/experimentIds")
    with field_named({**fields, "start": "/refinement"}, "/experimentIds"):
        refined: Estimate = request.refinement.build().estimate(found.model, data)
    return refined


def _fields(estimator: PlugInDocument, pointer: str, data: str) -> dict[str, str]:
    """Where the arguments that misuse names stand in the request: options, data, or the structure."""
    options = {name: f"{pointer}/{to_camel(name)}" for name in type(estimator).model_fields}
    return {**options, **dict.fromkeys(OF_DATA, data), "order": "/structure", "dependence": "/basis"}


def _document(
    plant: Plant, request: StateSpaceModelRequest, experiments: Sequence[Experiment], found: Found
) -> dict[str, Any]:
    designs = {experiment.design_id for experiment in experiments}
    asked = request.as_json()
    structure, basis, own_bases = chosen(plant, request)
    guarantee = refined_guarantee(request.refinement, found)
    return {
        **{name: asked[name] for name in ("name", "description", "spectralEstimator")},
        "softwareVersion": __version__,
        "origin": "identified",
        "structure": structure.as_json(),
        "basis": basis.as_json(),
        "coefficientBases": [own.as_json() for own in own_bases],
        **model_documents(found),
        "localModels": [],
        "localEstimator": None,
        "lpvEstimator": None,
        "experimentIds": list(request.experiment_ids),
        "designId": designs.pop() if len(designs) == 1 else None,
        "parentId": None,
        "seed": None,
        "stateSpace": state_space_result(plant, request, found, guarantee),
    }
