"""Requests that are told apart by their kind."""

from typing import Any, get_args

from pydantic import model_validator

from app.schemas.common import CamelModel


def with_kind(body: Any, kind: str) -> Any:
    """A body with the kind that it means where it does not say it, as those of earlier versions."""
    return {"kind": kind, **body} if isinstance(body, dict) and "kind" not in body else body


class KindRequest(CamelModel):
    """A request of one kind, which may be left out where nothing else can be meant."""

    @model_validator(mode="before")
    @classmethod
    def _of_its_kind(cls, body: Any) -> Any:
        (kind,) = get_args(cls.model_fields["kind"].annotation)
        return with_kind(body, kind)

    def asked(self) -> dict[str, Any]:
        """What it asks for, without its kind: the mark that repeated requests are known by."""
        return self.model_dump(mode="json", exclude={"kind"})
