"""Models: identify, state, list, look, evaluate."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.routers.downloads import file_answer, file_response
from app.schemas.designs import DesignRequest
from app.schemas.extensions import ExtensionRequest
from app.schemas.identification import IdentificationRequest
from app.schemas.jobs import Job
from app.schemas.models import Model, ModelFrequencyResponse, ModelList, StatedModelRequest
from app.schemas.simulations import SimulationRequest
from app.schemas.state_space import StateSpaceModelRequest
from app.schemas.varying import VaryingModelRequest
from app.services import (
    designs,
    extensions,
    identification,
    model_files,
    model_responses,
    models,
    simulations,
)
from app.services.jobs import accepted
from identification.exports import exports

router = APIRouter(prefix="/models", tags=["models"])

Finite = Annotated[float, Query(allow_inf_nan=False)]


@router.post("", status_code=202)
def create_model(
    body: IdentificationRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """Identify a model from experiments: rational, in state space, or from a record along varying scheduling."""
    return accepted(identification.submit(container, body, key), response)


@router.post("/state-space", status_code=202, deprecated=True)
def create_state_space_model(
    body: StateSpaceModelRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """The kind `stateSpace` of `POST /v1/models`, which answers the same."""
    return accepted(identification.submit(container, IdentificationRequest(body), key), response)


@router.post("/varying", status_code=202, deprecated=True)
def create_varying_model(
    body: VaryingModelRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """The kind `varyingScheduling` of `POST /v1/models`, which answers the same."""
    return accepted(identification.submit(container, IdentificationRequest(body), key), response)


@router.post("/stated", status_code=201)
def state_model(body: StatedModelRequest, resources: ResourcesDependency, response: Response) -> Model:
    """State a model, e.g. a first guess to design the first experiments with."""
    model = models.state(resources, body)
    response.headers["Location"] = f"/v1/models/{model.id}"
    return model


@router.get("")
def list_models(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> ModelList:
    """Models, newest first."""
    return models.page(resources, plant_id, limit, cursor)


@router.get("/{modelId}")
def get_model(modelId: str, resources: ResourcesDependency) -> Model:
    """One model with its accuracy and where it came from."""
    return models.get(resources, modelId)


@router.get("/{modelId}/usual-design")
def get_usual_design(modelId: str, container: ContainerDependency) -> DesignRequest:
    """A request for `POST /v1/designs` to begin with: band, sample time, levels and what is known, from the data."""
    return designs.usual(container, modelId)


@router.get("/{modelId}/file", response_class=Response, responses=file_answer("csv", "c"))
def get_model_file(
    modelId: str,
    resources: ResourcesDependency,
    format: Annotated[
        str, Query(description="for which use", max_length=40, json_schema_extra={"enum": sorted(exports())})
    ] = "coefficients",
) -> Response:
    """A model for other programs: coefficients over the range with deviations as CSV, or C99 that allocates nothing.

    Of rational models without effects; C99 in discrete time without an estimated delay.
    """
    content, ending = model_files.as_file(resources, modelId, format)
    return file_response(content, f"model-{modelId}", ending)


@router.post("/{modelId}/extensions", status_code=202)
def create_extension(
    modelId: str,
    body: ExtensionRequest,
    container: ContainerDependency,
    response: Response,
    key: IdempotencyKey = None,
) -> Job:
    """Add a physical effect to a model; makes a new version of it beside the old one."""
    return accepted(extensions.submit(container, modelId, body, key), response)


@router.post("/{modelId}/simulations", status_code=202)
def create_simulation(
    modelId: str,
    body: SimulationRequest,
    container: ContainerDependency,
    response: Response,
    key: IdempotencyKey = None,
) -> Job:
    """Simulate a model, e.g. as a dry run of an experiment.

    Along p(t) from rest, in discrete time; or one period of the steady state at operating points, for rational models
    of every kind, with effects or without, and for models from varying scheduling with one input and output.
    """
    return accepted(simulations.submit(container, modelId, body, key), response)


@router.get("/{modelId}/frequency-response")
def get_model_frequency_response(
    modelId: str,
    resources: ResourcesDependency,
    operating_point: Annotated[
        list[Finite], Query(alias="operatingPoint", max_length=10, description="one value a scheduling variable")
    ],
    minimum: Annotated[
        float, Query(alias="minimumRadPerSecond", ge=0, allow_inf_nan=False, description="lowest frequency")
    ],
    maximum: Annotated[
        float, Query(alias="maximumRadPerSecond", gt=0, allow_inf_nan=False, description="highest frequency")
    ],
    count: Annotated[
        int, Query(ge=1, le=2000, description="frequencies, spread logarithmically unless the lowest is zero")
    ] = 200,
    output_number: Annotated[int, Query(alias="outputNumber", ge=1, le=50, description="which output, from 1")] = 1,
    input_number: Annotated[int, Query(alias="inputNumber", ge=1, le=50, description="which input, from 1")] = 1,
) -> ModelFrequencyResponse:
    """The frequency response of one output to one input at one operating point, with 95 % bands."""
    channel = output_number, input_number
    return model_responses.frequency_response(resources, modelId, operating_point, (minimum, maximum, count), channel)
