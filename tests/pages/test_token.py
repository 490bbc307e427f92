"""With a token, shells hold nothing and data need it; the browser asks for it once and sends it with everything."""

from collections.abc import Iterator

import httpx
import pytest

from tests.support.browser import Visit
from tests.support.server import Server, running_server


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that asks for a token."""
    with running_server(
        tmp_path_factory.mktemp("guarded") / "data", {"LPV_OED_TOKEN": "s3cret-of-the-team"}
    ) as running:
        yield running


def test_shells_need_no_token_and_data_do(server: Server) -> None:
    assert httpx.get(f"{server.url}/plants").status_code == 200
    assert httpx.get(f"{server.url}/v1/plants").status_code == 401
    assert httpx.get(f"{server.url}/elsewhere").status_code == 401


def test_the_token_is_asked_for_and_sent(visit: Visit) -> None:
    page = visit.page
    page.goto("/plants")
    page.get_by_role("dialog").wait_for()
    assert visit.violations() == []
    for token in ("wrong", "s3cret-of-the-team"):
        page.get_by_role("textbox", name="Token").fill(token)
        page.get_by_role("button", name="Go on").click()
        if token == "wrong":
            page.get_by_text("does not know this token").wait_for()
    page.get_by_text("There is no plant yet").wait_for()
    page.get_by_role("button", name="Make an example").click()
    page.wait_for_url("**/plants/*")
    visit.wait()
    assert "experiments" in page.locator("#steps").inner_text()
    visit.faults = [fault for fault in visit.faults if "status of 401" not in fault]
