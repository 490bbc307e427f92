"""Who is answered, and how much may be sent."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import anyio
import pytest
from fastapi import FastAPI, Request
from fastapi.testclient import TestClient

from app.main import create_app
from app.settings import Settings

LIMIT = 2048
HOME = "http://127.0.0.1"


def application(directory: Path, **given: Any) -> FastAPI:
    made = create_app(Settings(data_dir=directory, max_body_bytes=LIMIT, **given))

    @made.post("/try/size")
    async def post_size(request: Request) -> int:
        return len(await request.body())

    @made.post("/try/json")
    def post_json(body: list[int]) -> int:
        return len(body)

    return made


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with TestClient(application(tmp_path_factory.mktemp("home")), base_url=HOME) as client:
        yield client


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    made = application(tmp_path_factory.mktemp("guarded"), token="s3cret-of-the-team", host="0.0.0.0")
    with TestClient(made, base_url="http://plant.example") as client:
        yield client


def refused(answer: Any, status: int) -> None:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["status"] == status


@pytest.mark.parametrize("size", [0, 1, LIMIT])
def test_a_body_up_to_the_limit_passes(home: TestClient, size: int) -> None:
    assert home.post("/try/size", content=b"1" * size).json() == size


@pytest.mark.parametrize("path", ["/try/size", "/try/json"])
@pytest.mark.parametrize("size", [LIMIT + 1, 100 * LIMIT])
def test_a_larger_body_is_refused(home: TestClient, path: str, size: int) -> None:
    headers = {"Content-Type": "application/json"}
    refused(home.post(path, content=b"1" * size, headers=headers), 413)


@pytest.mark.parametrize("path", ["/try/size", "/try/json"])
def test_a_larger_body_without_a_length_is_refused(home: TestClient, path: str) -> None:
    chunks = (b"1" * 1000 for _ in range(3))
    answer = home.post(path, content=chunks, headers={"Content-Type": "application/json"})
    assert "content-length" not in answer.request.headers
    refused(answer, 413)


def test_no_more_is_read_than_the_limit(tmp_path: Path) -> None:
    read, statuses = 0, []

    async def endless() -> dict[str, Any]:
        nonlocal read
        read += 1000
        return {"type": "http.request", "body": b"1" * 1000, "more_body": True}

    async def send(message: Any) -> None:
        statuses.append(message.get("status"))

    headers = [(b"host", b"localhost"), (b"transfer-encoding", b"chunked")]
    scope = {"type": "http", "method": "POST", "path": "/try/size", "raw_path": b"/try/size", "headers": headers}
    scope |= {"query_string": b"", "server": ("127.0.0.1", 80), "scheme": "http", "http_version": "1.1"}
    with TestClient(application(tmp_path), base_url=HOME) as client:
        anyio.run(client.app, scope, endless, send)
    assert statuses[0] == 413
    assert read == 3000


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.1:8000", "localhost", "LOCALHOST:1", "[::1]", "[::1]:8000"])
def test_this_machine_is_answered(home: TestClient, host: str) -> None:
    assert home.get("/v1/jobs", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host",
    ["evil.example", "127.0.0.1.evil.example", "", "[::1", "10.0.0.1", "a@evil.example", "localhost@evil.example"],
)
def test_other_names_are_refused(home: TestClient, host: str) -> None:
    refused(home.get("/v1/jobs", headers={"Host": host}), 400)


def test_pages_of_elsewhere_are_refused(home: TestClient) -> None:
    refused(home.get("/v1/jobs", headers={"Origin": "https://evil.example"}), 403)
    refused(home.get("/v1/jobs", headers={"Origin": "null"}), 403)
    assert home.get("/v1/jobs", headers={"Origin": "http://localhost:5173"}).status_code == 200


def test_without_a_token_only_loopback_connections_are_answered(tmp_path: Path) -> None:
    with TestClient(application(tmp_path), base_url="http://192.0.2.7") as client:
        refused(client.get("/v1/health", headers={"Host": "localhost"}), 403)


@pytest.mark.parametrize(
    "given",
    [
        None,
        "",
        "Bearer",
        "Bearer ",
        "Bearer s3cret-of-the-tea",
        "Bearer s3cret-of-the-teams",
        "Basic s3cret-of-the-team",
        "s3cret-of-the-team",
        "Bearer \xe9",
    ],
)
def test_without_the_token_nothing_is_answered(guarded: TestClient, given: str | None) -> None:
    headers = {} if given is None else {"Authorization": given.encode("latin-1")}
    for path in ("/v1/jobs", "/v1/openapi.json", "/v1/health/", "/nowhere"):
        answer = guarded.get(path, headers=headers)  # type: ignore[arg-type]
        refused(answer, 401)
        assert answer.headers["www-authenticate"] == "Bearer"


@pytest.mark.parametrize(
    "given", ["Bearer s3cret-of-the-team", "bearer s3cret-of-the-team", "BEARER  s3cret-of-the-team"]
)
def test_with_the_token_any_name_is_answered(guarded: TestClient, given: str) -> None:
    assert guarded.get("/v1/jobs", headers={"Authorization": given}).status_code == 200


def test_health_needs_no_token(guarded: TestClient) -> None:
    assert guarded.get("/v1/health").json()["status"] == "ok"
