"""Whether the service is there."""

from fastapi import APIRouter

from app import __version__
from app.dependencies import ContainerDependency
from app.schemas.jobs import Health

router = APIRouter(tags=["service"])


@router.get("/health")
def get_health(container: ContainerDependency) -> Health:
    """Answers once the service can take requests; needs no token."""
    container.database.check()
    return Health(version=__version__)
