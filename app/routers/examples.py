"""Examples: a simulated plant with measurements in one request."""

from fastapi import APIRouter, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.schemas.examples import Example, ExampleList, ExampleRequest, MeasurementRequest, SimulatedMeasurement
from app.schemas.jobs import Job
from app.services import examples
from app.services.jobs import accepted

router = APIRouter(tags=["examples"])


@router.post("/examples", status_code=202)
def create_example(
    body: ExampleRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """Make a simulated plant with an effect hidden in it, and experiments on it, some of them to be held out."""
    return accepted(examples.submit(container, body, key), response)


@router.get("/examples")
def list_examples(resources: ResourcesDependency, limit: Limit = 50, cursor: Cursor = None) -> ExampleList:
    """Examples, newest first."""
    return examples.page(resources, limit, cursor)


@router.get("/examples/{exampleId}")
def get_example(exampleId: str, resources: ResourcesDependency) -> Example:
    """One example: its plant and experiments, and what it hides."""
    return examples.get(resources, exampleId)


@router.post("/examples/{exampleId}/measurements", status_code=202)
def create_measurement(
    exampleId: str,
    body: MeasurementRequest,
    container: ContainerDependency,
    response: Response,
    key: IdempotencyKey = None,
) -> Job:
    """Play designed signals on the simulated plant; makes an experiment of each."""
    return accepted(examples.submit_measurement(container, exampleId, body, key), response)


@router.get("/measurements/{measurementId}")
def get_measurement(measurementId: str, resources: ResourcesDependency) -> SimulatedMeasurement:
    """One measurement of a simulated plant: the experiments that it made."""
    return examples.get_measurement(resources, measurementId)
