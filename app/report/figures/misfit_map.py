"""Where a model fails: normalised residuals over operating point and frequency."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from app.report.axes import FREQUENCY, hertz
from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import SEQUENTIAL, new_figure
from identification.arrays import ComplexArray, FloatArray, IntArray
from identification.comparison.batch import CLASS_NAMES, EXCITED

CELLS = 60
BRIGHTEST = 10.0
TICKS = (1.0, 2.0, 5.0, 10.0)


@dataclass(frozen=True, eq=False)
class MapRow:
    """Residuals z (F,) of one experiment at frequencies (F,) rad/s with line classes; E|z|² = 1 where all fits."""

    label: str
    held_out: bool
    frequencies: FloatArray
    residual: ComplexArray
    classes: IntArray

    def size(self, chosen: FloatArray | None = None) -> float:
        """The root mean square of z, or of the chosen lines; not a number where there are none."""
        z = self.residual if chosen is None else self.residual[chosen.astype(bool)]
        return float(np.sqrt(np.mean(abs(z) ** 2))) if len(z) else float("nan")

    def cells(self, excited: bool, edges: FloatArray) -> FloatArray:
        """Root mean square of z at excited or other lines between `edges` (C + 1,), as (C,).

        A cell without lines takes the nearest one's where the lines lie farther apart than cells, else not a number.
        """
        chosen = (self.classes == EXCITED) == excited
        frequencies, power = self.frequencies[chosen], abs(self.residual[chosen]) ** 2
        count, total = (np.histogram(frequencies, edges, weights=w)[0] for w in (None, power))
        with np.errstate(invalid="ignore"):
            values = np.sqrt(total / count)
        for i in np.flatnonzero(count == 0) if len(frequencies) else ():
            middle = np.sqrt(edges[i] * edges[i + 1])
            nearest = int(np.argmin(abs(frequencies - middle)))
            gap = np.diff(frequencies)[max(nearest - 1, 0) : nearest + 1].max(initial=0.0)
            if abs(frequencies[nearest] - middle) <= gap / 2:
                values[i] = np.sqrt(power[nearest])
        return np.asarray(values)


def misfit_map(rows: Sequence[MapRow]) -> Plot:
    """A map for excited lines and one for the others, of what was fitted and of what was held out."""
    panes = [pane for pane in _panes(rows) if pane[1]]
    counts = [len(own) for _, own, _ in panes]
    height = 150 + 26 * sum(counts) + 45 * len(panes)
    figure = new_figure([title for title, _, _ in panes], heights=[c / sum(counts) for c in counts], height=height)
    edges = _edges(rows)
    for place, (_, own, excited) in enumerate(panes, start=1):
        _add_map(figure, own, excited, edges, place)
    figure.update_xaxes(type="log", dtick="D2", showgrid=False, range=np.log10(hertz(edges[[0, -1]])).tolist())
    figure.update_xaxes(title=FREQUENCY, row=len(panes), col=1)
    figure.update_layout(coloraxis=_colours(), margin={"t": 30})
    caption = (
        "Root mean square of the residuals divided by their standard deviation: 1 (dark) is what noise alone gives,"
        f" {BRIGHTEST:g} and more is brightest. A row for each experiment; misfit at unexcited lines is nonlinearity."
    )
    return Plot(figure, caption, map_table(rows))


def map_table(rows: Sequence[MapRow]) -> Table:
    """Root mean squares by experiment and class of lines."""
    heads = ("experiment", "data", *(f"{name} lines" for name in CLASS_NAMES))
    lines = tuple(
        (row.label, "held out" if row.held_out else "fitted", *(_shown(row, number) for number in range(3)))
        for row in rows
    )
    return Table(heads, lines, "Root mean square of the normalised residuals; 1 is noise alone", text_columns=2)


def _shown(row: MapRow, number: int) -> str:
    return significant(row.size(row.classes == number))


def _panes(rows: Sequence[MapRow]) -> list[tuple[str, list[MapRow], bool]]:
    found = []
    for held_out in (False, True):
        own = [row for row in rows if row.held_out == held_out]
        data = "held out" if held_out else "fitted"
        found.append((f"{data}, excited lines", own, True))
        silent = [row for row in own if np.any(row.classes != EXCITED)]
        found.append((f"{data}, unexcited lines", silent, False))
    return found


def _edges(rows: Sequence[MapRow]) -> FloatArray:
    """Edges of cells of equal ratio over the excited frequencies of all experiments."""
    excited = np.concatenate([row.frequencies[(row.classes == EXCITED) & (row.frequencies > 0)] for row in rows])
    low, high = float(excited.min()), float(excited.max())
    return np.geomspace(low / 1.02, max(high * 1.02, low * 1.1), CELLS + 1)


def _add_map(figure: go.Figure, rows: Sequence[MapRow], excited: bool, edges: FloatArray, place: int) -> None:
    values = np.stack([row.cells(excited, edges) for row in rows])
    figure.add_heatmap(
        x=hertz(edges),
        y=np.arange(len(rows)),
        z=np.log10(np.clip(values, 1.0, BRIGHTEST)),
        customdata=values,
        hovertemplate="%{x:.3g} Hz: %{customdata:.2f}<extra></extra>",
        coloraxis="coloraxis",
        row=place,
        col=1,
    )
    labels = {"tickvals": list(range(len(rows))), "ticktext": [row.label for row in rows]}
    figure.update_yaxes(tickmode="array", showgrid=False, row=place, col=1, **labels)


def _colours() -> dict[str, object]:
    ticks = {"tickvals": np.log10(TICKS).tolist(), "ticktext": [f"{tick:g}" for tick in TICKS]}
    bar = {"title": {"text": "|z|"}, "thickness": 12, "outlinewidth": 0, **ticks}
    return {"colorscale": SEQUENTIAL, "cmin": 0.0, "cmax": float(np.log10(BRIGHTEST)), "colorbar": bar}
