"""What a gallery consists of, and how it is written as Markdown with pictures beside it."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import plotly.graph_objects as go

from app.report.numbers import significant
from app.report.svg.draw import draw

HEAD = "| what | printed | ours | off | |\n|---|---:|---:|---:|---|\n"


@dataclass(frozen=True)
class Cell:
    """A number that a paper prints beside ours; `note` says what the comparison depends on.

    `drawn`: it depends on draws or data that the paper does not give, so that no difference is told.
    """

    what: str
    printed: float | None
    ours: float
    note: str = ""
    drawn: bool = False

    @property
    def off(self) -> float | None:
        """ours / printed − 1; None where the paper's own data do not determine it."""
        return None if self.printed in (None, 0) or self.drawn else self.ours / float(self.printed or 1) - 1


@dataclass(frozen=True, eq=False)
class Part:
    """A table, a figure or a text of a paper: cells, pictures by the name of their file, what stands in its place."""

    title: str
    command: str
    cells: tuple[Cell, ...] = ()
    pictures: tuple[tuple[str, str, go.Figure], ...] = ()  # file, what it shows, figure
    text: str = ""


@dataclass(frozen=True, eq=False)
class Paper:
    """The parts of one paper, in its order."""

    key: str
    title: str
    parts: tuple[Part, ...]


def results(module: str, *options: str) -> Any:
    """The JSON that a benchmark writes, run as its own command."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "results.json"
        command = [sys.executable, "-m", f"benchmarks.{module}", *options, "--output", str(file)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return json.loads(file.read_text())


def write(papers: Sequence[Paper], page: Path, intro: str) -> None:
    """The page, and its pictures in a folder of its name beside it."""
    folder = page.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    blocks = [intro, *(_paper(paper, folder) for paper in papers)]
    page.write_text("\n".join(blocks).rstrip() + "\n", encoding="utf-8")


def _paper(paper: Paper, folder: Path) -> str:
    return f"## {paper.title} [{paper.key}]\n\n" + "\n".join(_part(part, folder) for part in paper.parts)


def _part(part: Part, folder: Path) -> str:
    lines = [f"### {part.title}\n"]
    if part.text:
        lines.append(part.text + "\n")
    if part.cells:
        lines.append(HEAD + "\n".join(_row(cell) for cell in part.cells) + "\n")
    for name, caption, figure in part.pictures:
        (folder / f"{name}.svg").write_text(_standing(draw(figure, name, caption)), encoding="utf-8")
        lines.append(f"![{caption}]({folder.name}/{name}.svg)\n")
    lines.append(f"`{part.command}`\n")
    return "\n".join(lines)


def _standing(svg: str) -> str:
    """A picture that stands alone, dark on any page."""
    return svg.replace("<svg ", '<svg color="#333" style="background:#fff" ', 1) + "\n"


def _row(cell: Cell) -> str:
    printed = "" if cell.printed is None else f"{cell.printed:g}"
    off = "" if cell.off is None else f"{100 * cell.off:+.2f} %"
    ours = f"{cell.ours:.0f}" if float(cell.ours).is_integer() else significant(cell.ours, 5)
    return f"| {cell.what} | {printed} | {ours} | {off} | {cell.note} |"
