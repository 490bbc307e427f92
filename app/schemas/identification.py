"""What a model is identified from, whatever its kind."""

from typing import Annotated, Any

from pydantic import Field, RootModel, model_validator

from app.schemas.models import ModelRequest
from app.schemas.requests import with_kind
from app.schemas.state_space import StateSpaceModelRequest
from app.schemas.varying import VaryingModelRequest


class IdentificationRequest(
    RootModel[Annotated[ModelRequest | StateSpaceModelRequest | VaryingModelRequest, Field(discriminator="kind")],]
):
    """A rational model, one in state space, or one from a record along varying scheduling, told apart by `kind`."""

    @model_validator(mode="before")
    @classmethod
    def _rational_unless_said(cls, body: Any) -> Any:
        return with_kind(body, "rational")
