"""Deleting, restoring and renaming: what all collections share."""

from typing import Literal

from pydantic import Field, model_validator

from app.schemas.common import CamelModel, Integer, Timestamp
from app.schemas.plants import LongText, Name

Collection = Literal[
    "plants",
    "experiments",
    "previews",
    "models",
    "comparisons",
    "diagnoses",
    "designs",
    "signals",
    "simulations",
    "staircases",
    "reports",
    "examples",
]


class ResourceLink(CamelModel):
    """A resource by its collection and identifier."""

    collection: str
    id: str
    href: str
    name: str = Field(description="empty where it has none")


class ResourceLinks(CamelModel):
    """Several resources."""

    items: list[ResourceLink]


class Deletion(CamelModel):
    """Something that was deleted, and may be restored under this identifier."""

    id: str
    deleted_at: Timestamp
    resource: ResourceLink = Field(description="what was asked to be deleted")
    others: Integer = Field(description="how many dependents were deleted with it")


class DeletionList(CamelModel):
    """A page of the bin."""

    items: list[Deletion]
    next_cursor: str | None = Field(default=None, description="give as `cursor` for the next page")


class RenameRequest(CamelModel):
    """A new name, a new description, or both."""

    name: Name | None = Field(default=None)
    description: LongText | None = Field(default=None)

    @model_validator(mode="after")
    def _something(self) -> "RenameRequest":
        if self.name is None and self.description is None:
            raise ValueError("give a name or a description")
        return self
