"""Figures of the running service."""

from fastapi import APIRouter, Response

from app.dependencies import ContainerDependency
from app.telemetry.metrics import MEDIA_TYPE

router = APIRouter(prefix="/metrics", tags=["service"])
TEXT = {200: {"description": "Text format of Prometheus", "content": {"text/plain": {"schema": {"type": "string"}}}}}


@router.get("", response_class=Response, responses=TEXT)  # type: ignore[arg-type]
def get_metrics(container: ContainerDependency) -> Response:
    """Requests and their times by route, jobs by state, event streams, room on the disk, for Prometheus."""
    return Response(container.metrics.text(), media_type=MEDIA_TYPE)
