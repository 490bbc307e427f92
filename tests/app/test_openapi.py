"""The published document has the shape that generators of clients need."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from app import openapi_export
from app.main import create_app
from app.settings import Settings

METHODS = {"get", "put", "post", "delete", "patch"}


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    return create_app(Settings()).openapi()


def operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, item in document["paths"].items():
        for method in METHODS & item.keys():
            yield f"{method} {path}", item[method]


def nodes(value: Any) -> Iterator[dict[str, Any]]:
    if isinstance(value, dict):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from nodes(inner)


def test_every_operation_has_a_lower_camel_name_of_its_own(document: dict[str, Any]) -> None:
    names = [operation["operationId"] for _, operation in operations(document)]
    assert len(names) == len(set(names))
    assert [name for name in names if not re.fullmatch(r"[a-z]+([A-Z][a-z0-9]*)*", name)] == []
    assert {"listJobs", "getJob", "cancelJob", "watchJobEvents", "getHealth"} <= set(names)


def test_every_failure_is_the_one_problem(document: dict[str, Any]) -> None:
    problem = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}
    for name, operation in operations(document):
        failures = {status: answer for status, answer in operation["responses"].items() if status[0] in "45"}
        assert "500" in failures, name
        assert all(answer["content"] == problem for answer in failures.values()), name
        if "requestBody" in operation:
            assert {"400", "413", "415", "422"} <= failures.keys(), name
        if "{" in name:
            assert "404" in failures, name


def test_numbers_are_doubles_and_there_are_no_tuples(document: dict[str, Any]) -> None:
    found = list(nodes(document))
    assert any(node.get("type") == "number" for node in found)
    assert [node for node in found if node.get("type") == "number" and node.get("format") != "double"] == []
    assert [node for node in found if "prefixItems" in node] == []


def test_no_parameter_is_null(document: dict[str, Any]) -> None:
    parameters = [parameter for _, operation in operations(document) for parameter in operation.get("parameters", ())]
    assert {parameter["in"] for parameter in parameters} == {"path", "query", "header"}
    assert [parameter for parameter in parameters if {"type": "null"} in parameter["schema"].get("anyOf", ())] == []


def test_no_unused_and_no_missing_components(document: dict[str, Any]) -> None:
    schemas = document["components"]["schemas"]
    used = {node["$ref"].rpartition("/")[2] for node in nodes(document) if isinstance(node.get("$ref"), str)}
    assert used <= schemas.keys()
    assert "HTTPValidationError" not in schemas
    assert "ValidationError" not in schemas
    assert schemas.keys() - used <= {"JobEvent"}


def test_documents_refuse_unknown_fields(document: dict[str, Any]) -> None:
    for name, schema in document["components"]["schemas"].items():
        if schema.get("type") == "object" and not name.startswith("Body"):
            assert schema.get("additionalProperties") is False, name


def test_events_are_a_stream_of_text(document: dict[str, Any]) -> None:
    answer = document["paths"]["/v1/jobs/{jobId}/events"]["get"]["responses"]["200"]
    assert answer["content"] == {"text/event-stream": {"schema": {"type": "string"}}}
    assert "JobEvent" in document["components"]["schemas"]


def test_the_document_is_the_same_whatever_the_settings(
    tmp_path: Path, document: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LPV_OED_HOST", "0.0.0.0")
    monkeypatch.setenv("LPV_OED_TOKEN", "t" * 16)
    assert create_app(Settings()).openapi() == document
    assert openapi_export.main(["--output", str(tmp_path / "a.json")]) == 0
    first = (tmp_path / "a.json").read_text()
    assert first == openapi_export.document()
    assert first.endswith("}\n")


def test_the_check_sees_a_difference(tmp_path: Path) -> None:
    output = tmp_path / "new" / "openapi.json"
    assert openapi_export.main(["--check", "--output", str(output)]) == 1
    assert openapi_export.main(["--output", str(output)]) == 0
    assert openapi_export.main(["--check", "--output", str(output)]) == 0
    output.write_text(output.read_text().replace("listJobs", "listjobs"))
    assert openapi_export.main(["--check", "--output", str(output)]) == 1


def test_no_field_has_a_name_of_one_letter(document: dict[str, Any]) -> None:
    """The generated Python client reads documents with variables of such names, which a field would replace."""
    fields = {name for node in nodes(document["components"]["schemas"]) for name in node.get("properties", {})}
    assert {"re", "matrixA"} <= fields
    assert {name for name in fields if len(name) == 1} == set()
