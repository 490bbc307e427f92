"""A browser for the pages, and pages that notice errors and requests to elsewhere."""

import os
import shutil
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.support.browser import Visit
from tests.support.server import Server

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext

MISSING = "no chromium: install Debian's chromium, or set CHROMIUM to a browser"
CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    skipped = [report for report in terminalreporter.stats.get("skipped", []) if MISSING in str(report.longrepr)]
    if skipped:
        terminalreporter.write_line(f"{len(skipped)} TESTS OF THE PAGES WERE NOT RUN: {MISSING}", red=True, bold=True)


@pytest.fixture(scope="module")
def browser() -> Iterator["Browser"]:
    """Debian's chromium, without a window; closed after each module, as its event loop is in the way of others."""
    if CHROMIUM is None:
        pytest.skip(MISSING)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield running
        running.close()


@pytest.fixture(scope="module")
def profile(browser: "Browser", server: Server) -> Iterator["BrowserContext"]:
    """One profile for a module, which keeps scripts between its pages."""
    with browser.new_context(base_url=server.url, viewport={"width": 1280, "height": 900}) as context:
        yield context


@pytest.fixture
def visit(profile: "BrowserContext", server: Server) -> Iterator[Visit]:
    """A new page on the running server; at the end there must have been no error."""
    visiting = Visit(profile.new_page(), server.url)
    yield visiting
    visiting.page.evaluate("localStorage.clear()")
    visiting.page.close()
    assert visiting.faults == []
