"""What the demonstration writes to the terminal, or to a file or pipe in its place."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table as RichTable

from app.demo.charts import bar, shaded
from app.report.document import Table
from app.report.figures.misfit_map import MapRow
from app.report.numbers import significant

INDENT = "      "
BAR_WIDTH = 28
MAP_WIDTH = 42


class Terminal:
    """Steps, sentences, tables, bars and maps."""

    def __init__(self, console: Console, steps: int) -> None:
        self._console = console
        self._steps = steps
        self._step = 0

    def title(self, text: str) -> None:
        """What this is."""
        self._console.print(f"[bold]{text}[/bold]", highlight=False)

    def step(self, text: str) -> None:
        """The next step of the story."""
        self._step += 1
        self._console.print(
            f"\n[bold cyan][{self._step}/{self._steps}][/bold cyan] [bold]{text}[/bold]", highlight=False
        )

    def say(self, text: str) -> None:
        """A sentence."""
        width = max(self._console.width - len(INDENT), 40)
        for line in self._console.render_str(text, highlight=False).wrap(self._console, width):
            self._console.print(INDENT, line, sep="", highlight=False)

    def path(self, path: Path, hint: str) -> None:
        """A path, never broken into lines, and what to do with it."""
        self._console.print(INDENT, f"[bold]{escape(str(path))}[/bold]", sep="", soft_wrap=True, highlight=False)
        self.say(hint)

    def table(self, table: Table) -> None:
        """A table without lines."""
        shown = RichTable(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="dim")
        for i, column in enumerate(table.columns):
            shown.add_column(escape(column), justify="left" if i < table.text_columns else "right", overflow="fold")
        for row in table.rows:
            shown.add_row(*map(escape, row))
        self._indented(shown)

    def bars(self, values: Sequence[tuple[str, float]], unit: str) -> None:
        """Bars in proportion to the largest value."""
        top = max(value for _, value in values)
        shown = RichTable(box=None, pad_edge=False, padding=(0, 2, 0, 0), show_header=False)
        for justify in ("left", "right", "left"):
            shown.add_column(justify=justify, no_wrap=justify != "left")
        for name, value in values:
            shown.add_row(
                escape(name), f"{significant(value, 4)} {unit}", f"[cyan]{bar(value / top, BAR_WIDTH)}[/cyan]"
            )
        self._indented(shown)

    def map(self, rows: Sequence[MapRow], low: float, high: float) -> None:
        """Where the residuals are larger than noise: a line an experiment, over the logarithm of frequency."""
        shown = RichTable(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="dim")
        shown.add_column("experiment", no_wrap=True)
        shown.add_column(f"residual/noise, {low:g} to {high:g} rad/s; █: > 10", no_wrap=True)
        for row in sorted(rows, key=lambda one: one.held_out):
            shown.add_row(escape(row.label), f"[cyan]▕{shaded(row, low, high, MAP_WIDTH)}▏[/cyan]")
        self._indented(shown)

    def _indented(self, shown: RichTable) -> None:
        grid = RichTable.grid()
        grid.add_row(INDENT, shown)
        self._console.print(grid)
