"""What the tests over HTTP share."""

import pytest

from tests.support.api import Api
from tests.support.server import Server


@pytest.fixture(scope="session")
def api(server: Server) -> Api:
    """Requests to the real server process."""
    return Api(server.url)
