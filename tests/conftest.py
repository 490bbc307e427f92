"""What all tests share: one thread per process for linear algebra, and a real server process on loopback."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.server import Server, running_server

ROOT = Path(__file__).resolve().parents[1]

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

# A module of these folders shares a server and costly results, so its tests stay together on one worker.
KEPT_TOGETHER = (ROOT / "tests" / "acceptance", ROOT / "tests" / "client", ROOT / "tests" / "pages")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if any(item.path.is_relative_to(folder) for folder in KEPT_TOGETHER):
            item.add_marker(pytest.mark.xdist_group(item.path.stem))


@pytest.fixture(scope="session")
def repository() -> Path:
    """The top folder of the checkout."""
    return ROOT


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A real server process with an empty data directory, shared by the tests of one worker."""
    with running_server(tmp_path_factory.mktemp("data")) as running:
        yield running
