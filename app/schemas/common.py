"""What all documents share: names, numbers, times, problems."""

from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic.alias_generators import to_camel

Double = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number; strings and booleans are refused."""

LARGEST_INTEGER = 2**53 - 1
Integer = Annotated[
    int, Field(strict=True, ge=-LARGEST_INTEGER, le=LARGEST_INTEGER, json_schema_extra={"format": "int64"})
]
"""A whole number that every JSON reader keeps exactly; strings and booleans are refused."""

Timestamp = Annotated[datetime, Field(strict=False)]
"""A moment in UTC, also read back from its ISO 8601 text."""


class CamelModel(BaseModel):
    """Base of every document: camelCase outside, unknown fields, not-a-number and infinities refused."""

    model_config = ConfigDict(
        alias_generator=to_camel,
        populate_by_name=True,
        extra="forbid",
        allow_inf_nan=False,
        strict=True,
        frozen=True,
    )

    def as_json(self) -> dict[str, Any]:
        """The document as plain JSON, as it is kept and sent."""
        return self.model_dump(by_alias=True, mode="json")


class FieldProblem(CamelModel):
    """What is wrong with one field of the request."""

    pointer: str = Field(description="JSON pointer into the body, or /name of a parameter")
    detail: str = Field(description="what is wrong with it and what to change")
    location: str = Field(default="body", description="where the field stands: body, query, path or header")


class Problem(CamelModel):
    """A problem as in RFC 9457, the body of every answer that is no success."""

    type: str = Field(description="URI that names the kind of problem")
    title: str = Field(description="the kind of problem in words")
    status: int = Field(description="HTTP status")
    detail: str = Field(description="what happened and what to change")
    instance: str | None = Field(default=None, description="what it happened to")
    errors: list[FieldProblem] = Field(default_factory=list, description="every bad field")
