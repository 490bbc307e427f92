"""Request files: YAML or JSON with the bodies of the HTTP API, checked by the same schemas."""

import re
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from app.errors import UnprocessableError
from app.json_pointer import body_pointer
from app.schemas.common import FieldProblem

Document = TypeVar("Document", bound=BaseModel)
MAX_FILE_BYTES = 256 * 1024 * 1024


class _Loader(yaml.SafeLoader):
    """YAML in which 1e-4 is a number, as in JSON."""


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$"),
    list("-+0123456789."),
)


def load(path: Path) -> dict[str, Any]:
    """The mapping in a file; raises UnprocessableError when there is none."""
    if path.stat().st_size > MAX_FILE_BYTES:
        raise UnprocessableError(f"{path} is larger than {MAX_FILE_BYTES} bytes")
    try:
        content = yaml.load(path.read_text(encoding="utf-8"), _Loader)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise UnprocessableError(f"{path} is neither YAML nor JSON: {error}") from None
    if not isinstance(content, dict):
        raise UnprocessableError(f"{path} must hold a mapping")
    return content


def section(content: dict[str, Any], name: str) -> Any:
    """A part of a request file; raises UnprocessableError when it is not there."""
    if name not in content:
        raise UnprocessableError.at(f"/{name}", f"{name} is missing")
    return content[name]


def checked(kind: type[Document], body: Any, pointer: str) -> Document:
    """A body as a document; raises UnprocessableError with a pointer to each bad field."""
    try:
        return kind.model_validate(body)
    except ValidationError as error:
        problems = [
            FieldProblem(
                pointer=pointer + body_pointer(failure["loc"], body, missing=failure["type"] == "missing"),
                detail=failure["msg"],
            )
            for failure in error.errors()
        ]
        raise UnprocessableError(f"{pointer} is not as it should be", problems) from None
