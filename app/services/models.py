"""Models: identified in a job, or stated."""

from collections.abc import Sequence
from typing import Any

from app import __version__
from app.container import Container
from app.conversion.extremes import within_doubles
from app.conversion.misuse import pointing
from app.conversion.models import accuracy_documents, check_covariance, range_documents, requested_structure
from app.conversion.plants import is_state_space, lpv_model, structure_and_dependence
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.experiments import Experiment
from app.schemas.models import Model as ModelDocument
from app.schemas.models import ModelList, ModelRequest, StatedModelRequest
from app.schemas.outcomes import OutcomeDocument
from app.schemas.plants import Plant
from app.services.documents import fields, items, named, of_plant
from app.services.experiments import experiment_of, local_experiments
from app.services.fitting import check_fitting, check_prior
from app.services.jobs import fingerprint
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository
from identification.models.model import Model
from identification.models.physical import RationalForm

KIND = "models"
STATE_SPACE = "the plant has a state-space structure; identify its models with kind stateSpace of POST /v1/models"
STATED_POINTERS = {"theta": "/theta", "covariance": "/covariance"}


def submit(container: Container, request: ModelRequest, key: str | None) -> JobRecord:
    """Start the job that identifies a model."""
    resources = container.resources
    plant = plant_of(named(resources, "plants", request.plant_id, "/plantId"))
    rows = local_experiments(resources, request.experiment_ids, plant.id, "/experimentIds")
    prior = None
    if request.prior_model_id is not None:
        row = named(resources, KIND, request.prior_model_id, "/priorModelId")
        prior = model_of(of_plant(row, plant.id, "/priorModelId"))
    task = payload(plant, request, [(experiment_of(row), row.arrays or "") for row in rows], prior)
    mark = fingerprint("createModel", request.asked())
    return container.ledger.submit("identification", task, KIND, plant.id, key, mark)


def payload(
    plant: Plant,
    request: ModelRequest,
    experiments: Sequence[tuple[Experiment, str]],
    prior: ModelDocument | None = None,
) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when experiments, structure and estimators do not fit."""
    if request.structure is None and is_state_space(plant.structure):
        raise UnprocessableError.at("/plantId", STATE_SPACE)
    pointers = {"basis": "/basis", "coefficient_bases": "/coefficientBases"}
    with pointing(pointers, default="/structure"):
        structure, dependence = requested_structure(plant, request)
    documents = [experiment for experiment, _ in experiments]
    check_fitting(request, structure, documents)
    if prior is None:
        with pointing({}, default="/experimentIds"):
            dependence.require_identifiable([experiment.held_at for experiment in documents])
    else:
        require_without_effects(prior, "/priorModelId")
        check_prior(plant, prior, structure, dependence, request.experiment_ids)
    return {
        "plant": plant.as_json(),
        "request": request.as_json(),
        "prior": prior and prior.as_json(),
        "experiments": [{"document": experiment.as_json(), "arrays": arrays} for experiment, arrays in experiments],
    }


def stated(plant: Plant, request: StatedModelRequest) -> dict[str, Any]:
    """The document of a stated model; raises UnprocessableError when it does not fit the plant or is unstable."""
    with pointing({}, default="/plantId"):
        structure, dependence = structure_and_dependence(plant)
    with pointing(STATED_POINTERS, default=""):
        model = lpv_model(structure, dependence, request.theta, request.covariance, request.noise_variance)
        check_covariance(model.theta_covariance)
    with pointing({}, default="/theta"), within_doubles():
        over_range = range_documents(model)
    if not over_range["stable"]:
        raise UnprocessableError.at("/theta", unstable_advice(structure, model))
    return {
        "softwareVersion": __version__,
        "origin": "stated",
        **{name: plant.as_json()[name] for name in ("structure", "basis", "coefficientBases")},
        **{name: request.as_json()[name] for name in ("name", "description")},
        "coefficientNames": list(structure.coefficient_names),
        "parameterNames": list(model.parameter_names),
        **accuracy_documents(model),
        **({} if request.covariance else {"covariance": None, "standardDeviations": None}),
        "outcome": OutcomeDocument(status="converged", advice="", iterations=0).as_json(),
        "tests": [],
        "localModels": [],
        "stable": True,
        "poles": [poles.as_json() for poles in over_range["poles"]],
        **dict.fromkeys(("localEstimator", "lpvEstimator", "spectralEstimator", "designId", "parentId", "seed")),
        "experimentIds": [],
    }


def state(resources: ResourceRepository, request: StatedModelRequest) -> ModelDocument:
    """Keep a stated model."""
    plant = plant_of(named(resources, "plants", request.plant_id, "/plantId"))
    return model_of(resources.add(KIND, stated(plant, request), plant.id))


def unstable_advice(structure: RationalForm, model: Model) -> str:
    """Why a model is refused."""
    what = "G is unstable" if structure.n_noise == 0 else "G, H or the inverse of H is unstable"
    names = ", ".join(model.parameter_names)
    return f"with these parameters ({names}) {what} somewhere in the range; correct theta or narrow the range"


def require_without_effects(model: ModelDocument, pointer: str, location: str = "body") -> None:
    """Raises UnprocessableError for a model with effects, where only the plant itself would be looked at."""
    if model.effects:
        kinds = ", ".join(one.kind for one in model.effects)
        raise UnprocessableError.at(
            pointer,
            f"the model carries effects ({kinds}) that are not taken into account here; name its parent",
            location,
        )


def model_of(resource: Resource) -> ModelDocument:
    """The model in a row."""
    return ModelDocument.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, model_id: str) -> ModelDocument:
    """The model of an identifier."""
    return model_of(resources.get(KIND, model_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> ModelList:
    """Part of the list of models."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return ModelList(items=items(found, model_of), next_cursor=found.next_cursor)
