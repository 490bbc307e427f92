"""The page stands alone: nothing fetched, nothing injected, a table behind every plot, the same bytes every time."""

from html.parser import HTMLParser
from pathlib import Path

import numpy as np

from app.report.document import Fact, Plot, Report, Section, Table
from app.report.page import render, write
from app.report.style import new_figure

NASTY = "</script><script>alert(1)</script>"


class Outline(HTMLParser):
    """Elements with their attributes, in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def count(self, tag: str) -> int:
        return sum(name == tag for name, _ in self.elements)


def report() -> Report:
    figure = new_figure()
    figure.add_scatter(x=np.arange(3.0), y=np.array([1.0, 4.0, 9.0]), name=NASTY)
    table = Table(("n", "n²"), (("1", "1"), ("2", NASTY)))
    plot = Plot(figure, NASTY, table)
    return Report(NASTY, "An introduction", (Fact("4", NASTY),), (Section(NASTY, (NASTY,), (table, plot, plot)),))


def test_nothing_is_fetched() -> None:
    outline = Outline(render(report()))
    fetched = [
        (tag, value)
        for tag, attributes in outline.elements
        for name, value in attributes.items()
        if name in {"src", "href", "srcset", "data", "action"} and not str(value).startswith("#")
    ]
    assert fetched == []
    policy = [a.get("content") for _, a in outline.elements if a.get("http-equiv") == "Content-Security-Policy"]
    assert policy
    assert str(policy[0]).startswith("default-src 'none'")
    assert "http" not in str(policy[0])


def test_text_cannot_become_code() -> None:
    text = render(report())
    assert NASTY not in text
    assert Outline(text).count("script") == 1  # the lines that save


def test_a_table_stands_behind_every_plot_and_ids_are_unique() -> None:
    outline = Outline(render(report()))
    ids = [attributes["id"] for _, attributes in outline.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    assert outline.count("figure") == outline.count("details") == 2
    assert outline.count("table") == 3


def test_the_same_report_is_the_same_page(tmp_path: Path) -> None:
    path = write(report(), tmp_path / "made" / "report.html")
    assert path.read_text(encoding="utf-8") == render(report())
