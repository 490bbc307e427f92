"""The generated client, once per worker."""

from types import ModuleType

import pytest

from tests.support import client


@pytest.fixture(scope="session")
def client_package(tmp_path_factory: pytest.TempPathFactory) -> ModuleType:
    """The client package generated from the committed OpenAPI document."""
    return client.load(client.generate(client.OPENAPI, tmp_path_factory.mktemp("client")))
