"""Named tokens: what each scope may do on every route, that they end, and that nobody can read or guess them."""

import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.access.throttle import MOST_FAILURES, SECONDS, Throttle
from app.access.tokens import Tokens
from app.main import create_app
from app.settings import Settings
from app.store.database import Database
from benchmarks.kill_restart import MODEL, PLANT

ADMINISTRATOR = "the-token-of-the-settings"
METHODS = ("get", "put", "post", "delete", "patch")


@pytest.fixture(scope="module")
def team(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A running application that asks for tokens."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("team"), token=ADMINISTRATOR)  # type: ignore[arg-type]
    with TestClient(create_app(settings), base_url="http://plant.example") as client:
        yield client


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


def made(team: TestClient, scope: str, **more: Any) -> tuple[dict[str, Any], str]:
    body = {"name": f"a {scope} token", "scope": scope, **more}
    answer = team.post("/v1/tokens", json=body, headers=bearer(ADMINISTRATOR))
    assert answer.status_code == 201, answer.text
    return answer.json()["token"], answer.json()["secret"]


def operations(client: TestClient) -> list[tuple[str, str]]:
    """Method and path of every operation of the published document."""
    document = client.app.openapi()  # type: ignore[attr-defined]
    return [(method, path) for path, item in document["paths"].items() for method in METHODS if method in item]


@pytest.mark.parametrize(("scope", "writes", "administers"), [("read", 0, 0), ("write", 1, 0), ("admin", 1, 1)])
def test_each_scope_may_do_what_it_says_on_every_route(
    team: TestClient, scope: str, writes: int, administers: int
) -> None:
    _, secret = made(team, scope)
    found = operations(team)
    assert len(found) > 40
    for method, path in found:
        filled = re.sub(r"\{\w+\}", "0" * 32, path)
        answer = team.request(method, filled, headers=bearer(secret), **({} if method == "get" else {"json": {}}))
        is_administration = path.startswith(("/v1/tokens", "/v1/audit"))
        allowed = administers if is_administration else method == "get" or writes
        assert (answer.status_code == 403) == (not allowed), (method, path, answer.text)
        assert answer.status_code != 401
        assert answer.status_code < 500


def test_every_route_needs_a_token_but_two(team: TestClient) -> None:
    open_paths = {path for method, path in operations(team) if team.request(method, path).status_code != 401}
    assert open_paths == {"/v1/health", "/v1/readiness"}


def test_a_read_only_token_changes_nothing(team: TestClient) -> None:
    _, reader = made(team, "read")
    _, writer = made(team, "write")
    plant = team.post("/v1/plants", json=PLANT, headers=bearer(writer)).json()["id"]
    assert team.post("/v1/plants", json=PLANT, headers=bearer(reader)).status_code == 403
    stated = team.post("/v1/models/stated", json=MODEL | {"plantId": plant}, headers=bearer(reader))
    assert stated.status_code == 403
    assert [one["id"] for one in team.get("/v1/plants", headers=bearer(reader)).json()["items"]] == [plant]
    assert team.get("/v1/models", headers=bearer(reader)).json()["items"] == []


def test_a_revoked_token_ends_at_once_and_a_rotated_one_after_its_overlap(team: TestClient) -> None:
    token, secret = made(team, "write")
    assert team.get("/v1/plants", headers=bearer(secret)).status_code == 200
    path = f"/v1/tokens/{token['id']}"
    new = team.post(f"{path}/rotation", json={"overlapHours": 1.0}, headers=bearer(ADMINISTRATOR)).json()
    assert (new["token"]["name"], new["token"]["scope"]) == (token["name"], "write")
    for one in (secret, new["secret"]):
        assert team.get("/v1/plants", headers=bearer(one)).status_code == 200
    revoked = team.post(f"{path}/revocation", headers=bearer(ADMINISTRATOR)).json()
    assert revoked["revokedAt"]
    assert team.get("/v1/plants", headers=bearer(secret)).status_code == 401
    assert team.get("/v1/plants", headers=bearer(new["secret"])).status_code == 200
    again = team.post(f"{path}/rotation", json={}, headers=bearer(ADMINISTRATOR))
    assert again.status_code == 404


def test_secrets_are_told_once_and_kept_nowhere(team: TestClient) -> None:
    _, secret = made(team, "read")
    assert secret not in team.get("/v1/tokens", headers=bearer(ADMINISTRATOR)).text
    directory: Path = team.app.state.container.settings.data_dir  # type: ignore[attr-defined]
    team.app.state.container.database.close()  # type: ignore[attr-defined]
    for path in directory.rglob("*"):
        assert not path.is_file() or secret.encode() not in path.read_bytes()


def test_a_token_ends_when_it_expires(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'a.sqlite'}")
    database.migrate()
    now = datetime(2026, 1, 1, tzinfo=UTC)
    _, secret = Tokens(database, None, lambda: now).make("a", "read", timedelta(days=1))
    for hours, works in ((23, True), (25, False)):
        later = Tokens(database, None, lambda hours=hours: now + timedelta(hours=hours))  # type: ignore[misc]
        assert (later.caller(secret) is not None) == works
    assert Tokens(database, None).caller("") is None
    rotated, _ = Tokens(database, None, lambda: now).rotate(Tokens(database, None).list()[0].id, timedelta(days=9))
    assert rotated.expires_at == now + timedelta(days=1)


def test_who_did_what_is_kept(team: TestClient) -> None:
    _, secret = made(team, "write")
    headers = {**bearer(secret), "X-Request-ID": "audited"}
    team.post("/v1/plants", json=PLANT, headers=headers)
    team.get("/v1/plants", headers=headers)
    lines = team.get("/v1/audit", params={"limit": 2}, headers=bearer(ADMINISTRATOR)).json()["items"]
    told = [(line["who"], line["method"], line["path"], line["status"]) for line in lines]
    assert told == [("a write token", "POST", "/v1/plants", 201), ("administrator", "POST", "/v1/tokens", 201)]
    assert lines[0]["requestId"] == "audited"


def test_where_no_token_is_asked_for_none_is_made(client: TestClient) -> None:
    answer = client.post("/v1/tokens", json={"name": "a", "scope": "read"})
    assert answer.status_code == 409
    assert "LPV_OED_TOKEN" in answer.json()["detail"]


def test_those_who_guess_wait_and_others_do_not(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, token=ADMINISTRATOR)  # type: ignore[arg-type]
    with TestClient(create_app(settings), base_url="http://plant.example") as client:
        guesses = [client.get("/v1/plants", headers=bearer(f"guess-{n}")) for n in range(MOST_FAILURES + 1)]
        assert [answer.status_code for answer in guesses] == [401] * MOST_FAILURES + [429]
        assert guesses[-1].headers["retry-after"] == f"{SECONDS:.0f}"
        assert client.get("/v1/plants", headers=bearer(ADMINISTRATOR)).status_code == 200


def test_guesses_are_forgotten_after_a_minute() -> None:
    now = 0.0
    throttle = Throttle(lambda: now)
    assert [throttle.failed("a") for _ in range(MOST_FAILURES + 1)] == [False] * MOST_FAILURES + [True]
    assert not throttle.failed("b")
    now = SECONDS + 1
    assert not throttle.failed("a")
