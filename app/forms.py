"""Upload forms refuse what JSON bodies refuse: fields that do not exist, and fields that are given twice."""

from typing import Any, TypeVar, get_origin

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import BaseModel, ValidationError

Document = TypeVar("Document", bound=BaseModel)


async def known_fields(request: Request) -> None:
    """A dependency of routes with a form: raises RequestValidationError for unknown and repeated fields."""
    route = request.scope["route"]
    assert isinstance(route, APIRoute), "forms belong to routes of the API"
    fields = {field.alias: field for field in route.dependant.body_params}
    names = [name for name, _ in (await request.form()).multi_items()]
    failures = []
    for name in dict.fromkeys(names):
        if name not in fields:
            known = ", ".join(fields)
            failures.append(_failure(name, "extra_forbidden", f"there is no such field; there are {known}"))
        elif names.count(name) > 1 and not _is_list(fields[name].field_info.annotation):
            failures.append(_failure(name, "repeated", "the field is given more than once; give it once"))
    if failures:
        raise RequestValidationError(failures, body=dict.fromkeys(names, ""))


def checked_form(kind: type[Document], form: dict[str, Any]) -> Document:
    """The fields of a form as a document; raises RequestValidationError."""
    try:
        return kind.model_validate(form)
    except ValidationError as error:
        failures = [{**failure, "loc": ("body", *failure["loc"])} for failure in error.errors()]
        raise RequestValidationError(failures, body=form) from None


def _failure(name: str, kind: str, message: str) -> dict[str, object]:
    return {"type": kind, "loc": ("body", name), "msg": message, "input": ""}


def _is_list(annotation: object) -> bool:
    options = getattr(annotation, "__args__", ())
    return get_origin(annotation) is list or any(get_origin(option) is list for option in options)
