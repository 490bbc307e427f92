"""Whatever goes wrong, the answer is one problem document that points to every bad field."""

from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
import pytest
from fastapi import FastAPI, File, HTTPException, UploadFile
from fastapi.testclient import TestClient
from pydantic import Field

from app.errors import ConflictError
from app.main import create_app
from app.schemas.common import CamelModel, Double, Integer, Problem
from app.settings import Settings
from app.store.arrays import ArraysTooLargeError
from identification.errors import ShapeError


class Tall(CamelModel):
    kind: Literal["tall"]
    height_metres: Double


class Wide(CamelModel):
    kind: Literal["wide"]
    widths_metres: list[Double]


class Shape(CamelModel):
    sample_count: Integer = Field(gt=0)
    shapes: list[Annotated[Tall | Wide, Field(discriminator="kind")]] = Field(default_factory=list)
    either: Integer | list[Integer] | None = None


def _routes(application: FastAPI) -> None:
    @application.get("/try/both")
    def get_both() -> None: ...

    @application.post("/try/both")
    def post_both() -> None: ...

    @application.post("/try/body")
    def post_body(body: Shape) -> Shape:
        return body

    @application.post("/try/file")
    def post_file(file: Annotated[UploadFile, File()]) -> int:
        return file.size or 0

    @application.get("/fail/{what}")
    def get_error(what: str) -> None:
        errors: dict[str, Exception] = {
            "misuse": ShapeError("3 inputs, 4 outputs; give as many", "sampled_output"),
            "conflict": ConflictError("taken"),
            "teapot": HTTPException(418, "short and stout"),
            "fault": RuntimeError("a secret of the inside"),
            "large": ArraysTooLargeError("too many samples"),
        }
        raise errors[what]


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    application = create_app(Settings(data_dir=tmp_path_factory.mktemp("data")))
    _routes(application)
    with TestClient(application, base_url="http://127.0.0.1", raise_server_exceptions=False) as running:
        yield running


def problem(answer: object, status: int) -> Problem:
    assert answer.status_code == status, answer.text  # type: ignore[attr-defined]
    assert answer.headers["content-type"] == "application/problem+json"  # type: ignore[attr-defined]
    found = Problem.model_validate(answer.json())  # type: ignore[attr-defined]
    assert found.status == status
    return found


def pointers(trial: TestClient, body: object) -> set[str]:
    found = problem(trial.post("/try/body", json=body), 422)
    assert all(field.location == "body" for field in found.errors)
    return {field.pointer for field in found.errors}


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ({}, {"/sampleCount"}),
        ([], {""}),
        (None, {""}),
        (3, {""}),
        ({"sampleCount": 0}, {"/sampleCount"}),
        ({"sampleCount": "1"}, {"/sampleCount"}),
        ({"sampleCount": True}, {"/sampleCount"}),
        ({"sampleCount": 1.5}, {"/sampleCount"}),
        ({"sampleCount": 2**53}, {"/sampleCount"}),
        ({"sampleCount": 10**400}, {"/sampleCount"}),
        ({"sampleCount": 1e300}, {"/sampleCount"}),
        ({"sampleCount": 1, "sample/~count": 2}, {"/sample~1~0count"}),
        ({"sampleCount": -1, "extra": 1}, {"/sampleCount", "/extra"}),
        ({"sampleCount": 1, "shapes": 1}, {"/shapes"}),
        ({"sampleCount": 1, "shapes": [{"kind": "round"}]}, {"/shapes/0"}),
        ({"sampleCount": 1, "shapes": [{}]}, {"/shapes/0"}),
        ({"sampleCount": 1, "shapes": [{"kind": "tall"}]}, {"/shapes/0/heightMetres"}),
        ({"sampleCount": 1, "shapes": [{"kind": "tall", "heightMetres": "1"}]}, {"/shapes/0/heightMetres"}),
        (
            {"sampleCount": 1, "shapes": [{"kind": "wide", "widthsMetres": [1, 2, "x"]}, {"kind": "tall"}]},
            {"/shapes/0/widthsMetres/2", "/shapes/1/heightMetres"},
        ),
        ({"sampleCount": 1, "either": [1, "x"]}, {"/either", "/either/1"}),
    ],
)
def test_every_bad_field_is_pointed_to(trial: TestClient, body: object, expected: set[str]) -> None:
    assert pointers(trial, body) == expected


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999", "1" + "0" * 400])
def test_no_numbers_and_infinities_are_refused(trial: TestClient, number: str) -> None:
    text = '{"sampleCount": 1, "shapes": [{"kind": "tall", "heightMetres": ' + number + "}]}"
    answer = trial.post("/try/body", content=text, headers={"Content-Type": "application/json"})
    found = problem(answer, 422)
    assert [field.pointer for field in found.errors] == ["/shapes/0/heightMetres"]


@pytest.mark.parametrize(
    "body",
    [b"{", b"", b"\xff\xfe", b'{"sampleCount": 1', b"[" * 100_000, b'{"sampleCount": ' + b"1" * 10_000 + b"}", b"nul"],
    ids=["open", "empty", "no UTF-8", "cut", "deep", "long number", "word"],
)
def test_what_is_no_json_is_a_bad_request(trial: TestClient, body: bytes) -> None:
    answer = trial.post("/try/body", content=body, headers={"Content-Type": "application/json"})
    problem(answer, 422 if not body else 400)


@pytest.mark.parametrize("text", ['{"sampleCount": 1, "\\ud800": 1}', '{"sampleCount": "\\ud800"}'])
def test_broken_text_in_the_body_does_not_break_the_answer(trial: TestClient, text: str) -> None:
    problem(trial.post("/try/body", content=text, headers={"Content-Type": "application/json"}), 422)


@pytest.mark.parametrize("media_type", [None, "text/plain", "application/xml", "multipart/form-data", "json", "/"])
def test_other_media_types_are_unsupported(trial: TestClient, media_type: str | None) -> None:
    headers = {} if media_type is None else {"Content-Type": media_type}
    found = problem(trial.post("/try/body", content='{"sampleCount": 1}', headers=headers), 415)
    assert "application/json" in found.detail


def test_json_where_a_file_is_expected_is_unsupported(trial: TestClient) -> None:
    assert "multipart/form-data" in problem(trial.post("/try/file", json={}), 415).detail


def test_a_form_without_its_file_points_to_it(trial: TestClient) -> None:
    found = problem(trial.post("/try/file", files={"other": b"1"}), 422)
    assert found.errors[0].pointer == "/file"
    found = problem(trial.post("/try/file", data={"file": "text"}, files={"other": b"1"}), 422)
    assert found.errors[0].pointer == "/file"


def test_a_broken_form_is_a_bad_request(trial: TestClient) -> None:
    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    for body in (b"--x\r\nbroken", b"--y\r\n\r\n--y--", b""):
        answer = trial.post("/try/file", content=body, headers=headers)
        assert answer.status_code in (400, 422)
        problem(answer, answer.status_code)


def test_misuse_is_unprocessable_and_names_the_field(trial: TestClient) -> None:
    found = problem(trial.get("/fail/misuse"), 422)
    assert found.errors[0].pointer == "/sampledOutput"
    assert "give as many" in found.detail


def test_other_errors_keep_their_status(trial: TestClient) -> None:
    assert problem(trial.get("/fail/conflict"), 409).instance == "/fail/conflict"
    assert problem(trial.get("/fail/teapot"), 418).detail == "short and stout"
    problem(trial.get("/fail/large"), 422)
    problem(trial.get("/nowhere"), 404)
    found = trial.put("/try/body")
    problem(found, 405)
    assert found.headers["allow"] == "POST"


def test_a_method_that_is_not_allowed_names_all_that_are(trial: TestClient) -> None:
    answer = trial.delete("/try/both")
    problem(answer, 405)
    assert answer.headers["allow"] == "GET, POST"
    assert trial.put("/v1/jobs").headers["allow"] == "GET"
    assert trial.get("/v1/jobs/x/cancellation").headers["allow"] == "POST"


def test_a_fault_tells_nothing_of_the_inside(trial: TestClient) -> None:
    answer = trial.get("/fail/fault")
    problem(answer, 500)
    assert "secret" not in answer.text


def test_a_finite_number_passes_unchanged(trial: TestClient) -> None:
    number = float(np.nextafter(1.0, 2.0))
    body = {"sampleCount": 1, "shapes": [{"kind": "tall", "heightMetres": number}]}
    assert trial.post("/try/body", json=body).json()["shapes"][0]["heightMetres"] == number
