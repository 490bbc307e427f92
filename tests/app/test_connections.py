"""What clients do to connections, on a real server: half a request, one too slow, odd targets, faults in between."""

import json
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import httpx
import pytest

from benchmarks.kill_restart import PLANT
from tests.support.patience import PATIENCE, until
from tests.support.server import Server, running_server

HEAD = b"POST /v1/plants HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: 100\r\n"
HALVES = {"nothing": b"", "half a head": HEAD, "half a body": HEAD + b"\r\n{", "a drip": b"GET / HT"}


@pytest.fixture(scope="module")
def hasty(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that waits for requests for a second only."""
    with running_server(tmp_path_factory.mktemp("hasty") / "data", {"LPV_OED_REQUEST_SECONDS": "1"}) as running:
        yield running


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    environment = {"LPV_OED_TOKEN": "s3cret-of-the-team"}
    with running_server(tmp_path_factory.mktemp("guarded") / "data", environment) as running:
        yield running


def connected(server: Server) -> socket.socket:
    port = int(server.url.rpartition(":")[2])
    return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)


def rest(connection: socket.socket) -> bytes:
    """All that comes until the server closes the connection."""
    received = b""
    while chunk := connection.recv(65536):
        received += chunk
    return received


@pytest.mark.parametrize("half", list(HALVES))
def test_a_request_that_does_not_come_in_time_ends_its_connection(hasty: Server, half: str) -> None:
    with connected(hasty) as connection:
        connection.sendall(HALVES[half])
        answer = rest(connection)
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 408 "), answer
    assert b"connection: close" in head.lower()
    assert b"application/problem+json" in head
    assert json.loads(body)["type"] == "urn:lpv-oed:problem:request-timeout"


def test_a_body_that_drips_ends_as_well(hasty: Server) -> None:
    with connected(hasty) as connection:
        connection.sendall(HEAD + b"\r\n")

        def dripped() -> bool:
            try:
                connection.sendall(b" ")
            except OSError:
                return True
            connection.setblocking(False)
            try:
                return bool(connection.recv(65536))
            except BlockingIOError:
                return False
            finally:
                connection.settimeout(PATIENCE)

        until(dripped, "the end of a body that drips", between=0.1)


def test_what_is_no_request_is_a_problem(hasty: Server) -> None:
    with connected(hasty) as connection:
        connection.sendall(b"\x16\x03\x01 nonsense\r\n\r\n")
        answer = rest(connection)
    assert answer.startswith(b"HTTP/1.1 400 ")
    assert json.loads(answer.partition(b"\r\n\r\n")[2])["status"] == 400


@pytest.mark.parametrize("half", ["half a head", "half a body"])
def test_a_stop_waits_for_no_half_request(tmp_path: Path, half: str) -> None:
    patient = running_server(tmp_path / "data", {"LPV_OED_REQUEST_SECONDS": "3600"})
    with patient as server, connected(server) as connection:
        connection.sendall(HALVES[half])
        server.process.send_signal(signal.SIGTERM)
        assert server.process.wait(timeout=PATIENCE) in (0, -signal.SIGTERM)
    assert "Application shutdown complete" in server.log_text()


TARGETS = [
    b"*",
    b"plants",
    b"",
    b"/",
    b"//",
    b"/%00",
    b"/plants/%ff",
    b"http://127.0.0.1/v1/jobs",
    b"static",
    b"?a",
    b"/v1/%2e",
]


@pytest.mark.parametrize("method", [b"GET", b"OPTIONS", b"POST"])
@pytest.mark.parametrize("target", TARGETS)
def test_no_target_is_a_fault(guarded: Server, method: bytes, target: bytes) -> None:
    with connected(guarded) as connection:
        connection.sendall(b"%s %s HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n" % (method, target))
        status = int(rest(connection).split(b" ")[1])
    assert status < 500
    assert "Traceback" not in guarded.log_text()


def test_after_a_refusal_the_connection_goes_on(guarded: Server) -> None:
    with http_client(guarded) as connection:
        assert [status(connection, "GET", "/v1/jobs") for _ in range(3)] == [401, 401, 401]


def test_after_a_fault_the_connection_goes_on(tmp_path: Path) -> None:
    full = running_server(tmp_path / "data", {"LPV_OED_DISK_RESERVE_BYTES": str(2**60)})
    with full as server, http_client(server) as connection:
        assert status(connection, "POST", "/v1/plants", PLANT) == 201
        plant = json.loads(httpx.get(f"{server.url}/v1/plants").text)["items"][0]["id"]
        record = {"kind": "timeRecord", "input": [0.0] * 50, "output": [0.0] * 50, "operatingPoint": [0.5]}
        body = record | {"plantId": plant, "sampleTimeSeconds": 1.0}
        assert status(connection, "POST", "/v1/experiments", body) == 507
        assert status(connection, "GET", "/v1/readiness") == 503
        assert status(connection, "GET", "/v1/health") == 200


@contextmanager
def http_client(server: Server) -> Iterator[HTTPConnection]:
    """One connection, which is never opened again."""
    connection = HTTPConnection(server.url.removeprefix("http://"), timeout=PATIENCE)
    connection.connect()
    connection.auto_open = 0
    try:
        yield connection
    finally:
        connection.close()


def status(connection: HTTPConnection, method: str, path: str, body: Any = None) -> int:
    connection.request(method, path, None if body is None else json.dumps(body), {"Content-Type": "application/json"})
    answer = connection.getresponse()
    answer.read()
    return answer.status
