"""Models of every kind: asked for in one request, identified in a job."""

from app.container import Container
from app.jobs.records import JobRecord
from app.schemas.identification import IdentificationRequest
from app.schemas.models import ModelRequest
from app.schemas.state_space import StateSpaceModelRequest
from app.services import models, state_space_models, varying_models


def submit(container: Container, request: IdentificationRequest, key: str | None) -> JobRecord:
    """Start the job that identifies a model of the kind that is asked for."""
    asked = request.root
    if isinstance(asked, ModelRequest):
        return models.submit(container, asked, key)
    if isinstance(asked, StateSpaceModelRequest):
        return state_space_models.submit(container, asked, key)
    return varying_models.submit(container, asked, key)
