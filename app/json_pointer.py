"""From where validation failed to where the sender finds it: a JSON pointer [RFC 6901]."""

from collections.abc import Sequence
from typing import Any

from pydantic.alias_generators import to_camel

Location = Sequence[str | int]


def body_pointer(location: Location, body: Any, missing: bool = False) -> str:
    """The pointer of a validation error into the body that was sent.

    `location` also names the branches of unions that were tried; these are no part of the body and are left out.
    `missing` says that the last step is a field that should have been there.
    """
    steps: list[str] = []
    for index, step in enumerate(location):
        if _leads_into(body, step):
            body = body[step]
        elif not (missing and index == len(location) - 1):
            continue
        steps.append(str(step))
    return pointer(steps)


def pointer(steps: Sequence[str]) -> str:
    """The pointer with these steps; the empty one is the whole body."""
    return "".join("/" + step.replace("~", "~0").replace("/", "~1") for step in steps)


def field_pointer(field: str) -> str:
    """The pointer of a field that misuse names: a pointer already, or an argument in snake case."""
    return field if field.startswith("/") else "/" + to_camel(field)


def _leads_into(value: Any, step: str | int) -> bool:
    if isinstance(value, list):
        return isinstance(step, int) and 0 <= step < len(value)
    return isinstance(value, dict) and step in value
