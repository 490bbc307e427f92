"""Whether the service is there, and whether it can work."""

from fastapi import APIRouter

from app import __version__
from app.dependencies import ContainerDependency
from app.errors import UnavailableError
from app.schemas.health import Health, Readiness

router = APIRouter(tags=["service"])


@router.get("/health")
async def get_health() -> Health:
    """Answers as long as the process is alive, whatever else is wrong; needs no token."""
    return Health(version=__version__)


@router.get("/readiness", responses={503: {"description": "The service cannot take in work; the problem says why"}})
def get_readiness(container: ContainerDependency) -> Readiness:
    """Answers 200 while the service can take in work, else 503 with every reason; needs no token."""
    reasons = container.readiness.reasons()
    if reasons:
        raise UnavailableError("; ".join(reasons), headers={"Retry-After": "10"})
    return Readiness(version=__version__)
