"""One running application for all tests of jobs that only need one, since child processes are slow to start."""

from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient

from app.main import create_app
from app.settings import MEBIBYTE, Settings
from tests.app.conftest import TASK_PACKAGES
from tests.app.jobs.bench import Bench


@pytest.fixture(scope="package")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("data"),
        task_packages=TASK_PACKAGES,
        job_memory_limit_bytes=512 * MEBIBYTE,
    )
    application = create_app(settings)
    with TestClient(application, base_url="http://127.0.0.1") as client:
        yield Bench(client, application.state.container)
