"""The names of the traces, in rows above the axes."""

from collections.abc import Sequence

from app.report.svg.elements import LINE, SIZE, element, text, width_of
from app.report.svg.marks import DASHES, mark
from app.report.svg.pane import Part

KEY = 26.0
GAP = 20.0


def entries(traces: Sequence[Part]) -> list[Part]:
    """The traces that the legend names; one alone needs none."""
    named = [trace for trace in traces if trace.get("name") and trace.get("showlegend", True)]
    return named if len(named) > 1 else []


def rows_of(named: Sequence[Part], width: float) -> list[list[Part]]:
    """As many in a row as fit."""
    rows: list[list[Part]] = [[]]
    used = 0.0
    for trace in named:
        needed = KEY + width_of(trace["name"]) + GAP
        if rows[-1] and used + needed > width:
            rows.append([])
            used = 0.0
        rows[-1].append(trace)
        used += needed
    return [row for row in rows if row]


def legend(rows: Sequence[Sequence[Part]], left: float, top: float) -> str:
    """A key and a name for each."""
    parts = []
    for i, row in enumerate(rows):
        x, y = left, top + (i + 0.7) * (LINE + 3)
        for trace in row:
            parts += [_key(trace, x, y), text(x + KEY, y + SIZE / 3, [str(trace["name"])], "start")]
            x += KEY + width_of(trace["name"]) + GAP
    return "".join(parts)


def _key(trace: Part, x: float, y: float) -> str:
    marker, line = trace.get("marker", {}), trace.get("line", {})
    colour = marker.get("color", line.get("color", "currentColor"))
    colour = colour if isinstance(colour, str) else colour[0]
    mode = trace.get("mode") or "lines+markers"
    if trace["type"] == "bar" or (trace.get("fill") and line.get("width") == 0):
        return element("rect", x=x, y=y - 5, width=18, height=10, fill=trace.get("fillcolor", colour))
    parts = ""
    if "lines" in mode:
        dashes = DASHES.get(line.get("dash", "solid"))
        width = line.get("width", 2)
        parts += element("path", d=f"M{x:.1f} {y:.1f}h20", stroke=colour, stroke_width=width, stroke_dasharray=dashes)
    if "markers" in mode:
        width = float(marker.get("line", {}).get("width", 0.0))
        parts += mark(marker.get("symbol", "circle"), x + 10, y, min(float(marker.get("size", 6)), 12), colour, width)
    return parts
