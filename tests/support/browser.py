"""A page in a browser that keeps what must not happen: errors on the console, requests to elsewhere."""

import re
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.support.patience import PATIENCE

if TYPE_CHECKING:
    from playwright.sync_api import Page

READY = "body[data-ready]"
DRAW_ALL = """async () => {
  for (const plot of document.querySelectorAll(".plot")) {
    if (!plot.checkVisibility()) continue;
    plot.scrollIntoView({ block: "nearest" });
    while (plot.isConnected && plot.dataset.waits !== undefined) await new Promise((resolve) => setTimeout(resolve, 5));
  }
}"""
SETTLED = "Promise.all(document.getAnimations().map((one) => one.finished.catch(() => null)))"
WIDTHS = (390, 1280)


class Visit:
    """One page of one context; `faults` lists errors on its console and requests beyond its server."""

    def __init__(self, page: "Page", url: str) -> None:
        self.page = page
        self.faults: list[str] = []
        self._url = url
        page.set_default_timeout(PATIENCE * 1000)
        page.on("console", self._console)
        page.on("pageerror", lambda error: self.faults.append(f"fault: {error}"))
        page.on("request", self._request)

    def open(self, path: str) -> "Page":
        """Go to a page and wait until all in the window is drawn."""
        self.page.goto(path)
        self.wait()
        return self.page

    def wait(self) -> None:
        """Wait until the page that was gone to is drawn in the window."""
        self.page.wait_for_selector(READY, state="attached")

    def draw_all(self) -> None:
        """Scroll to one plot after the other and wait until it is drawn."""
        self.page.evaluate(DRAW_ALL)

    def look(self, folder: Path, name: str) -> None:
        """Pictures in light and dark, narrow and wide."""
        self.draw_all()
        for scheme in ("light", "dark"):
            self.page.emulate_media(color_scheme=scheme)
            for width in WIDTHS:
                self.page.set_viewport_size({"width": width, "height": 900})
                self.page.evaluate(SETTLED)
                self.page.screenshot(path=folder / f"{name}-{scheme}-{width}.png", full_page=True)
        self.page.emulate_media(color_scheme="light")

    def expect_refusal(self, status: int) -> None:
        """Forget what the browser says on its console about one answer that was meant to be refused."""
        told = next((fault for fault in self.faults if f"status of {status}" in fault), None)
        assert told is not None, self.faults
        self.faults.remove(told)

    def violations(self) -> list[str]:
        """What axe-core finds serious or critical on the page with all plots, and whether it is too wide."""
        self.draw_all()
        return self._grave() + [f"wider than {width} pixels" for width in WIDTHS if self._is_wider(width)]

    def _is_wider(self, width: int) -> bool:
        self.page.set_viewport_size({"width": width, "height": 900})
        wider: bool = self.page.evaluate(f"document.documentElement.scrollWidth > {width}")
        return wider

    def _grave(self) -> list[str]:
        self.page.evaluate(_axe())
        found: list[dict[str, Any]] = self.page.evaluate("axe.run().then((results) => results.violations)")
        grave = [one for one in found if one["impact"] in ("serious", "critical")]
        return [f"{one['id']}: {node['html'][:200]} {node['any'][:1]}" for one in grave for node in one["nodes"]]

    def _console(self, message: Any) -> None:
        if message.type in ("error", "warning"):
            self.faults.append(f"{message.type}: {message.text} at {message.location.get('url')}")

    def _request(self, request: Any) -> None:
        if not request.url.startswith(f"{self._url}/") and not re.match(r"blob:|data:", request.url):
            self.faults.append(f"request: {request.url}")


@cache
def _axe() -> str:
    specification = find_spec("axe_playwright_python")
    assert specification is not None
    assert specification.origin is not None
    return (Path(specification.origin).parent / "axe.min.js").read_text(encoding="utf-8")
