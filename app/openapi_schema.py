"""The published OpenAPI document, in the shape that client generators understand."""

import json
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute

from app.errors import MEDIA_TYPE
from app.schemas.common import Problem
from app.schemas.jobs import JobEvent

Json = dict[str, Any]
REFERENCE = "#/components/schemas/{model}"
PUBLISHED = (Problem, JobEvent)
DESCRIPTION = (
    "Identification of linear parameter-varying systems with the least input energy for a guaranteed accuracy: "
    "describe a plant, design experiments, identify from what was measured, see where the model fails, find the "
    "physical effect that is missing and add it."
)
_METHODS = ("get", "put", "post", "delete", "patch")
_ALWAYS = {400: "The request cannot be read", 401: "The bearer token is missing or wrong"}
_ALWAYS |= {429: "Too many wrong tokens came from this address"}
_ALWAYS |= {
    403: "The token does not allow this, or this origin is not answered",
    500: "A fault of the service",
    503: "The database is out of reach",
}
_WITH_BODY = {408: "The body did not come in time", 507: "The disk is full; nothing was kept"}
_WITH_BODY |= {413: "The body is too large", 415: "The content type of the body is not the expected one"}


def operation_id(route: APIRoute) -> str:
    """The name of the function in lower camel case."""
    first, *rest = route.name.split("_")
    return first + "".join(word.capitalize() for word in rest)


def install_openapi(application: FastAPI) -> None:
    """Make the application publish the document that `build` returns."""

    def openapi() -> Json:
        if not application.openapi_schema:
            application.openapi_schema = build(application)
        return application.openapi_schema

    application.openapi = openapi  # type: ignore[method-assign]


def build(application: FastAPI) -> Json:
    """The OpenAPI document of all routes."""
    document = get_openapi(
        title=application.title,
        version=application.version,
        description=DESCRIPTION,
        routes=application.routes,
        separate_input_output_schemas=False,
    )
    schemas = document.setdefault("components", {}).setdefault("schemas", {})
    for model in PUBLISHED:
        _publish(model.model_json_schema(ref_template=REFERENCE, by_alias=True), model.__name__, schemas)
    for path in document["paths"].values():
        for method in _METHODS:
            if method in path:
                _declare_problems(path[method])
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    document["components"]["securitySchemes"] = {"bearer": {"type": "http", "scheme": "bearer"}}
    document["security"] = [{}, {"bearer": []}]
    _polish(document)
    return document


def _publish(schema: Json, name: str, schemas: Json) -> None:
    for inner, definition in schema.pop("$defs", {}).items():
        schemas.setdefault(inner, definition)
    schemas.setdefault(name, schema)


def _declare_problems(operation: Json) -> None:
    possible = dict(_ALWAYS)
    has_parameters = bool(operation.get("parameters"))
    if "requestBody" in operation:
        possible |= _WITH_BODY
    if has_parameters or "requestBody" in operation:
        possible[422] = "A field is not as it should be; every bad one is named"
    if any(parameter["in"] == "path" for parameter in operation.get("parameters", ())):
        possible[404] = "There is no such resource"
    if any(parameter["name"] == "Idempotency-Key" for parameter in operation.get("parameters", ())):
        possible[409] = "The Idempotency-Key was used for another request"
    responses = operation["responses"]
    stated = {status: answer["description"] for status, answer in responses.items() if status[0] in "45"}
    stated = {status: text for status, text in stated.items() if text != "Validation Error"}
    for status, description in ({str(status): text for status, text in possible.items()} | stated).items():
        reference = {"$ref": REFERENCE.format(model="Problem")}
        responses[status] = {"description": description, "content": {MEDIA_TYPE: {"schema": reference}}}


def _without_null(schema: Json) -> Json:
    branches = [branch for branch in schema.pop("anyOf") if branch != {"type": "null"}]
    return schema | (branches[0] if len(branches) == 1 else {"anyOf": branches})


def _as_sent(schema: Json) -> None:
    """Fields as they are sent: one that does not apply is absent, not null; one with a default may be left out.

    Generators take a field with a default for one that is always there, so the default is told in words.
    """
    properties = schema["properties"]
    for name, field in properties.items():
        if "default" in field:
            default = field.pop("default")
            told = [field.get("description", ""), "" if default in (None, "", []) else f"default {json.dumps(default)}"]
            field |= {"description": "; ".join(filter(None, told))} if any(told) else {}
        if {"type": "null"} in field.get("anyOf", ()):
            properties[name] = _without_null(field)
            schema["required"] = [one for one in schema.get("required", ()) if one != name]
    if not schema.get("required", True):
        del schema["required"]


def _polish(node: Any) -> None:
    """Numbers are doubles; titles that only repeat a name go, and so do nulls that are never sent."""
    if isinstance(node, dict):
        if isinstance(node.get("properties"), dict) and node.get("type") == "object":
            _as_sent(node)
        if "in" in node and "anyOf" in node.get("schema", {}):
            node["schema"] = _without_null(node["schema"])
        if node.get("type") == "number":
            node.setdefault("format", "double")
        repeated = [*node.get("properties", {}).values(), node["schema"] if "in" in node else None]
        for schema in filter(None, repeated):
            schema.pop("title", None)
    for inner in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        _polish(inner)
