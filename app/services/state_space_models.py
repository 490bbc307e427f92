"""State-space models: checked, and identified in a job."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic.alias_generators import to_camel

from app.container import Container
from app.conversion.misuse import pointing
from app.conversion.plants import channels, sample_time
from app.conversion.state_space import requested_state_space
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.experiments import Experiment
from app.schemas.plants import Plant, StateSpaceStructureDocument
from app.schemas.state_space import StateSpaceModelRequest
from app.services.documents import named
from app.services.experiments import experiment_of, local_experiments
from app.services.fitting import check_sample_time
from app.services.jobs import fingerprint
from app.services.models import KIND
from app.services.plants import plant_of
from identification.scheduling import ParameterDependence

TASK = "state_space_identification"
MAX_REFINED_ENTRIES = 500


def submit(container: Container, request: StateSpaceModelRequest, key: str | None) -> JobRecord:
    """Start the job that identifies a state-space model."""
    resources = container.resources
    plant = plant_of(named(resources, "plants", request.plant_id, "/plantId"))
    rows = local_experiments(resources, request.experiment_ids, plant.id, "/experimentIds")
    task = payload(plant, request, [(experiment_of(row), row.arrays or "") for row in rows])
    mark = fingerprint("createStateSpaceModel", request.asked())
    return container.ledger.submit(TASK, task, KIND, plant.id, key, mark)


def payload(
    plant: Plant, request: StateSpaceModelRequest, experiments: Sequence[tuple[Experiment, str]]
) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when experiments, structure and estimators do not fit."""
    pointers = {"basis": "/basis", "coefficient_bases": "/coefficientBases"}
    with pointing(pointers, default="/structure"):
        structure, dependence = requested_state_space(plant, request)
    _check_estimators(request, structure)
    documents = [experiment for experiment, _ in experiments]
    _check_experiments(request, structure, documents)
    if request.parametric_estimator is not None:
        with pointing({}, default="/experimentIds"):
            dependence.require_identifiable([experiment.held_at for experiment in documents])
    if request.refinement is not None:
        _check_refinement(plant, request, structure, dependence)
    return {
        "plant": plant.as_json(),
        "request": request.as_json(),
        "experiments": [{"document": experiment.as_json(), "arrays": arrays} for experiment, arrays in experiments],
    }


def _check_estimators(request: StateSpaceModelRequest, structure: StateSpaceStructureDocument) -> None:
    """Something is asked for, and each estimator can be made for the order of the structure."""
    order = structure.order
    if request.subspace_estimator is None and request.parametric_estimator is None:
        raise UnprocessableError.at(
            "/subspaceEstimator", "choose a subspace estimator, a parametric estimator, or both"
        )
    if request.subspace_estimator is not None:
        estimator = request.subspace_estimator.build(order=order)
        _check_block_rows(estimator, order, "/subspaceEstimator/blockRows")
        _check_hold(request, estimator, structure)
    if request.parametric_estimator is not None:
        if order is None:
            raise UnprocessableError.at(
                "/structure", "a parameter-varying model needs an order; state it as `order` of the structure"
            )
        asked = request.parametric_estimator
        pointers = {name: f"/parametricEstimator/{to_camel(name)}" for name in type(asked).model_fields}
        with pointing({**pointers, "order": "/structure"}, default="/parametricEstimator"):
            asked.build(order=order)


def _check_block_rows(estimator: Any, order: int | None, pointer: str) -> None:
    rows = getattr(estimator, "block_rows", None)
    if rows is not None and rows <= (order or 0):
        raise UnprocessableError.at(
            pointer, f"{rows} block rows cannot show order {order or 1}; take at least {(order or 1) + 1}"
        )


def _check_hold(request: StateSpaceModelRequest, estimator: Any, structure: StateSpaceStructureDocument) -> None:
    if not getattr(estimator, "zero_order_hold", False):
        return
    pointer = "/subspaceEstimator/zeroOrderHold"
    if sample_time(structure) is not None:
        raise UnprocessableError.at(pointer, "undoing a hold gives a model in continuous time; choose that structure")
    if request.parametric_estimator is not None:
        raise UnprocessableError.at(pointer, "the parametric estimator undoes no hold; identify one after the other")


def _check_experiments(
    request: StateSpaceModelRequest, structure: StateSpaceStructureDocument, experiments: Sequence[Experiment]
) -> None:
    held = request.subspace_estimator is not None and getattr(request.subspace_estimator, "zero_order_hold", False)
    for i, experiment in enumerate(experiments):
        pointer, is_record = f"/experimentIds/{i}", experiment.kind == "timeRecord"
        if is_record and request.spectral_estimator is None:
            raise UnprocessableError.at(
                "/spectralEstimator", "choose how the time records become the frequency responses that are fitted"
            )
        if held and experiment.sample_time_seconds is None:
            raise UnprocessableError.at(pointer, "there is no hold in a response in continuous time")
        if not held and not (is_record and sample_time(structure) is None):
            check_sample_time(experiment, sample_time(structure), pointer)


def _check_refinement(
    plant: Plant,
    request: StateSpaceModelRequest,
    structure: StateSpaceStructureDocument,
    dependence: ParameterDependence,
) -> None:
    if request.parametric_estimator is None:
        raise UnprocessableError.at("/refinement", "there is nothing to refine without a parametric estimator")
    (n_y, n_u), n = channels(plant), structure.order or 1
    entries = int(np.dot(dependence.sizes, (n * n, n * n_u, n_y * n, n_y * n_u)))
    if entries > MAX_REFINED_ENTRIES:
        raise UnprocessableError.at(
            "/refinement",
            f"the matrices have {entries} entries, at most {MAX_REFINED_ENTRIES} can be refined; choose a lower"
            " order or a smaller basis",
        )
