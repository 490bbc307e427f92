"""What operations ask FastAPI for."""

from typing import Annotated

from fastapi import Depends, Header, Query, Request

from app.container import Container
from app.jobs.ledger import Ledger
from app.store.resources import ResourceRepository


def get_container(request: Request) -> Container:
    """The parts of the service that answers this request."""
    container: Container = request.app.state.container
    return container


ContainerDependency = Annotated[Container, Depends(get_container)]


def get_ledger(container: ContainerDependency) -> Ledger:
    return container.ledger


def get_resources(container: ContainerDependency) -> ResourceRepository:
    return container.resources


LedgerDependency = Annotated[Ledger, Depends(get_ledger)]
ResourcesDependency = Annotated[ResourceRepository, Depends(get_resources)]

IdempotencyKey = Annotated[
    str | None,
    Header(
        alias="Idempotency-Key",
        min_length=1,
        max_length=255,
        description="the same key with the same request gives the same job, with another request a conflict",
    ),
]
Limit = Annotated[int, Query(ge=1, le=500, description="most items in one answer")]
Cursor = Annotated[str | None, Query(pattern=r"^[0-9a-f]{32}$", description="nextCursor of the answer to be continued")]
