"""The whole loop by clicks alone: from an example that hides something to the error that has fallen."""

import re

from tests.support.browser import Visit

SEED = 23  # hides a cubic stiffness
SEEDED = f"""
  const random = crypto.getRandomValues.bind(crypto);
  crypto.getRandomValues = (values) => (values instanceof Uint32Array ? values.fill({SEED}) : random(values));
"""


def check(visit: Visit) -> None:
    """What every page of the loop must show, in light and dark: nothing grave for axe, nothing beyond the window."""
    for scheme in ("light", "dark"):
        visit.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        assert visit.violations() == []


def gone_to(visit: Visit, path: str) -> None:
    visit.page.wait_for_url(re.compile(f"{path}$"))
    visit.wait()
    check(visit)


def test_a_newcomer_makes_the_error_fall_by_clicks(visit: Visit) -> None:
    page = visit.page
    page.add_init_script(SEEDED)
    visit.open("/plants")
    page.get_by_role("button", name="Make an example").click()
    gone_to(visit, r"/plants/\w{32}")
    page.get_by_role("link", name="identify a model").click()
    gone_to(visit, "/identify")
    page.get_by_role("button", name="Identify a model").click()
    gone_to(visit, r"/compare/\w+")
    assert "The model fails" in page.locator("#verdict").inner_text()
    page.get_by_role("button", name="Look for what is missing").click()
    gone_to(visit, r"/diagnose/\w+")
    assert "cubic stiffness" in page.locator("#verdict").inner_text()
    page.locator("#ranking li").first.get_by_role("button", name="Add this effect").click()
    gone_to(visit, r"/history\?model=\w+")
    headline = page.locator("#headline").inner_text()
    assert "The error has fallen on the held-out experiments" in headline
    assert "cubic stiffness" in headline
    page.get_by_role("link", name="Compare the new version").click()
    gone_to(visit, r"/compare\?model=\w+")
    page.get_by_role("button", name="Compare", exact=True).click()
    gone_to(visit, r"/compare/\w+")
    assert "The model fails" not in page.locator("#verdict").inner_text()
    for link in ("Models", "Diagnose", "History"):
        page.get_by_role("navigation", name="Plant").get_by_role("link", name=link).click()
        visit.wait()
        check(visit)
