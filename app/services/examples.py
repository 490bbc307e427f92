"""Examples: asked for, and made in a job together with their plant and experiments."""

from app.container import Container
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.examples import Example, ExampleList, ExampleRequest, MeasurementRequest, SimulatedMeasurement
from app.services.documents import fields, items, named, of_plant
from app.services.jobs import fingerprint
from app.services.signals import signals_of
from app.store.resources import Resource, ResourceRepository
from app.virtual_plant.stage import LONGEST_SAMPLE_TIME

KIND = "examples"
MEASUREMENTS = "measurements"
MOST_SAMPLES = 100_000


def submit(container: Container, request: ExampleRequest, key: str | None) -> JobRecord:
    """Start the job that makes an example."""
    mark = fingerprint("createExample", request.model_dump(mode="json"))
    return container.ledger.submit("example", {"request": request.as_json()}, KIND, None, key, mark)


def submit_measurement(
    container: Container, example_id: str, request: MeasurementRequest, key: str | None
) -> JobRecord:
    """Start the job that plays signals on the plant of an example."""
    example = get(container.resources, example_id)
    row = named(container.resources, "signals", request.signals_id, "/signalsId")
    signals = signals_of(of_plant(row, example.plant_id, "/signalsId"))
    if sum(one.samples for one in signals.signals) > MOST_SAMPLES:
        raise UnprocessableError.at("/signalsId", f"at most {MOST_SAMPLES} samples are simulated; make shorter signals")
    if any(one.sample_time_seconds > LONGEST_SAMPLE_TIME for one in signals.signals):
        raise UnprocessableError.at(
            "/signalsId", f"the plant is fast: it needs samples every {LONGEST_SAMPLE_TIME:g} s or more often"
        )
    task = {"request": request.as_json(), "example": example.as_json(), "signals": signals.as_json()}
    mark = fingerprint("createMeasurement", example_id, request.model_dump(mode="json"))
    return container.ledger.submit(
        "measurement", {**task, "arrays": row.arrays}, MEASUREMENTS, example.plant_id, key, mark
    )


def get_measurement(resources: ResourceRepository, measurement_id: str) -> SimulatedMeasurement:
    """The measurement of an identifier."""
    row = resources.get(MEASUREMENTS, measurement_id)
    return SimulatedMeasurement.model_validate(fields(row, "plantId", "jobId"))


def example_of(resource: Resource) -> Example:
    """The example in a row."""
    return Example.model_validate(fields(resource, "jobId"))


def get(resources: ResourceRepository, example_id: str) -> Example:
    """The example of an identifier."""
    return example_of(resources.get(KIND, example_id))


def page(resources: ResourceRepository, limit: int, cursor: str | None) -> ExampleList:
    """Part of the list of examples."""
    found = resources.list(KIND, limit=limit, cursor=cursor)
    return ExampleList(items=items(found, example_of), next_cursor=found.next_cursor)
