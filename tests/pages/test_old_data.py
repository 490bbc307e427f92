"""What an earlier version made is drawn by the pages of this one."""

from collections.abc import Iterator

import pytest

from tests.support.api import Api, Json
from tests.support.browser import Visit
from tests.support.old_data import unpacked
from tests.support.server import Server, running_server

PLACES = {
    "experiments": "experiments/{id}",
    "models": "models/{id}",
    "designs": "design/{id}",
    "comparisons": "compare/{id}",
    "diagnoses": "diagnose/{id}",
}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with running_server(unpacked(tmp_path_factory.mktemp("old") / "data")) as running:
        yield running


def one_of_each(items: list[Json]) -> list[Json]:
    return list({(one.get("kind"), one.get("origin")): one for one in items}.values())


@pytest.mark.parametrize("kind", PLACES)
def test_it_is_drawn(visit: Visit, server: Server, kind: str) -> None:
    for one in one_of_each(Api(server.url).get(f"/{kind}", limit=100)["items"]):
        plant = one.get("plantId") or one["plant"]["id"]
        page = visit.open(f"/plants/{plant}/{PLACES[kind].format(**one)}")
        visit.draw_all()
        assert page.locator("[role=alert]").count() == 0
        assert page.locator("h1").count() == 1
