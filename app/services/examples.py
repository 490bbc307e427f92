"""Examples: asked for, and made in a job together with their plant and experiments."""

from app.container import Container
from app.jobs.records import JobRecord
from app.schemas.examples import Example, ExampleList, ExampleRequest
from app.services.documents import fields, items
from app.services.jobs import fingerprint
from app.store.resources import Resource, ResourceRepository

KIND = "examples"


def submit(container: Container, request: ExampleRequest, key: str | None) -> JobRecord:
    """Start the job that makes an example."""
    mark = fingerprint("createExample", request.model_dump(mode="json"))
    return container.ledger.submit("example", {"request": request.as_json()}, KIND, None, key, mark)


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
