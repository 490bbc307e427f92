"""The committed OpenAPI document gives a complete Python client without a warning."""

import json
import re
from pathlib import Path
from types import ModuleType

import pytest

from tests.support import client

METHODS = {"get", "put", "post", "delete", "patch"}


def snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).replace("-", "_").lower()


def operations() -> list[tuple[str, str]]:
    """Tag and operationId of everything in the document."""
    paths = json.loads(client.OPENAPI.read_text(encoding="utf-8"))["paths"]
    entries = (entry for path in paths.values() for method, entry in path.items() if method in METHODS)
    return [(entry["tags"][0], entry["operationId"]) for entry in entries]


def test_every_operation_has_a_function_of_the_client(client_package: ModuleType) -> None:
    found = operations()
    assert len(found) == len(set(found)) > 10
    for tag, name in found:
        assert callable(client.operation(client_package, snake(tag), snake(name)).sync_detailed)


def test_operation_names_are_lower_camel() -> None:
    assert [name for _, name in operations() if not re.fullmatch(r"[a-z][a-zA-Z0-9]*", name)] == []


def test_a_document_that_the_generator_cannot_use_is_not_passed_over(tmp_path: Path) -> None:
    document = tmp_path / "openapi.json"
    unusable = {"get": {"operationId": "getPlant", "responses": {"200": {"description": "", "content": {"a/b": {}}}}}}
    document.write_text(
        json.dumps({"openapi": "3.1.0", "info": {"title": "t", "version": "1"}, "paths": {"/a": unusable}})
    )
    with pytest.raises(client.GenerationError):
        client.generate(document, tmp_path)
