"""An application in this process, with an empty data directory and the trial jobs besides the real ones."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from app.container import Container
from app.main import create_app
from app.settings import Settings

TASK_PACKAGES = ("app.jobs.tasks", "tests.app.trial_tasks")


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_dir=tmp_path / "data", task_packages=TASK_PACKAGES)


@pytest.fixture
def client(settings: Settings) -> Iterator[TestClient]:
    """A client of a running application; asks 127.0.0.1 because other names are refused."""
    with TestClient(create_app(settings), base_url="http://127.0.0.1") as running:
        yield running


@pytest.fixture
def container(client: TestClient) -> Container:
    """The parts of the application that `client` talks to."""
    found: Container = client.app.state.container  # type: ignore[attr-defined]
    return found
