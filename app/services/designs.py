"""Designs: asked for, and made in a job."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from app.container import Container
from app.conversion.designs import candidate_points, energy_caps, plant_limits, searched_model
from app.conversion.effects import extended_model
from app.conversion.misuse import pointing
from app.conversion.models import kept_model
from app.conversion.usual_designs import seen_in, usual_design
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.designs import Design, DesignList, DesignRequest
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.services.documents import fields, items, named, of_plant
from app.services.experiments import experiment_of
from app.services.jobs import fingerprint
from app.services.measured import Measured, check_logged, check_time_domain, measured_of_plant, payload_of
from app.services.models import model_of
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "designs"
MOST_LOOKED_AT = 50
POINTERS = {"excluded_points": "/excludedPoints", "energy_caps": "/energyCaps"}


def submit(container: Container, request: DesignRequest, key: str | None) -> JobRecord:
    """Start the job that designs experiments."""
    plant = plant_of(named(container.resources, "plants", request.plant_id, "/plantId"))
    row = of_plant(named(container.resources, "models", request.model_id, "/modelId"), plant.id, "/modelId")
    experiments = []
    if request.prior_experiment_ids is not None:
        pointer = "/priorExperimentIds"
        experiments = measured_of_plant(container.resources, request.prior_experiment_ids, plant.id, pointer)
    task = payload(plant, model_of(row), request, experiments)
    mark = fingerprint("createDesign", request.model_dump(mode="json"))
    return container.ledger.submit("design", task, KIND, plant.id, key, mark)


def payload(plant: Plant, model: Model, request: DesignRequest, experiments: Sequence[Measured] = ()) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when the request does not fit plant, model and experiments."""
    _check_prior(model, request, experiments)
    with pointing({}, default="/modelId"):
        known = kept_model(model, plant)
    with pointing(POINTERS, default="/operatingPoints"):
        searched = searched_model(request, known)
        points = candidate_points(request, searched.dependence)
    with pointing(POINTERS, default="/energyCaps"):
        energy_caps(request, points, searched.dependence)
        plant_limits(request, searched, points)
    if request.noise_variance is None and not known.noise_variance > 0:
        raise UnprocessableError.at("/modelId", "the model has no noise, so any experiment would be accurate enough")
    if not known.structure.is_discrete and request.sample_time_seconds is None:
        raise UnprocessableError.at("/sampleTimeSeconds", "needed for a plant in continuous time")
    if request.band is not None and request.band.minimum_rad_per_second > request.band.maximum_rad_per_second:
        raise UnprocessableError.at("/band", "the band must rise")
    return {
        "plant": plant.as_json(),
        "model": model.as_json(),
        "request": request.as_json(),
        "experiments": payload_of(experiments),
    }


def usual(container: Container, model_id: str) -> DesignRequest:
    """A request that gives a design from a model as it is; raises UnprocessableError for state-space models."""
    row = container.resources.get("models", model_id)
    document = model_of(row)
    plant = plant_of(container.resources.get("plants", document.plant_id))
    with pointing({}, default="/modelId", location="path"):
        kept_model(document, plant)
        model = extended_model(document, plant)
    found = [container.resources.find("experiments", one) for one in document.experiment_ids]
    kept = [(experiment_of(one), one.arrays) for one in found if one is not None]
    records = [(one, arrays) for one, arrays in kept if one.kind == "timeRecord" and arrays is not None]
    levels = [float(np.std(container.arrays.get(arrays)["input"])) for _, arrays in records[:MOST_LOOKED_AT]]
    seen = seen_in(model, [one for one, _ in kept], levels)
    return DesignRequest.model_validate(usual_design(document, plant, model, seen))


def _check_prior(model: Model, request: DesignRequest, experiments: Sequence[Measured]) -> None:
    """Raises UnprocessableError when what is known already cannot be counted."""
    covariance = model.joint_covariance if model.effects else model.covariance
    if request.use_prior_information and covariance is None:
        raise UnprocessableError.at("/usePriorInformation", "the model has no covariance")
    if request.promise is not None and covariance is None:
        raise UnprocessableError.at("/promise", "the model has no covariance from which parameters could be drawn")
    if request.use_prior_information and experiments:
        detail = "the model was learnt from experiments too, and what they tell would count twice; give one of the two"
        raise UnprocessableError.at("/priorExperimentIds", detail)
    if request.prior_experiment_ids and not experiments:
        raise UnprocessableError.at("/priorExperimentIds", "only the service knows experiments by their identifiers")
    check_time_domain(model, experiments, "/priorExperimentIds")
    check_logged(model, experiments, "/priorExperimentIds")


def design_of(resource: Resource) -> Design:
    """The design in a row."""
    return Design.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, design_id: str) -> Design:
    """The design of an identifier."""
    return design_of(resources.get(KIND, design_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> DesignList:
    """Part of the list of designs."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return DesignList(items=items(found, design_of), next_cursor=found.next_cursor)
