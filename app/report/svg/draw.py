"""A figure of plotly as SVG: axes, grids, traces, legend, in the colours of the page around it.

Draws what the figures of a report use: curves with areas and error bars, bars, maps in colour, linear, logarithmic and
category axes in one column of panes. Text takes the colour of the page; the picture scales with its width.
"""

from collections.abc import Mapping, Sequence

import plotly.graph_objects as go

from app.report.svg.axes import Axis, axes_of
from app.report.svg.bars import bars
from app.report.svg.elements import LINE, SIZE, element, lines_of, text, width_of
from app.report.svg.heatmap import colour_bar, colours_of, heatmap
from app.report.svg.legend import entries, legend, rows_of
from app.report.svg.marks import DASHES
from app.report.svg.pane import Box, Pane, Part
from app.report.svg.scatter import scatter

WIDTH = 800.0
TICK = 5.0
RIGHT_OF_MAP = 62.0


def draw(figure: go.Figure, identifier: str, label: str) -> str:
    """The figure as one svg element; `identifier` keeps its parts apart from those of others on the page."""
    layout = figure.layout.to_plotly_json()
    traces = [{"xaxis": "x", "yaxis": "y", **trace.to_plotly_json()} for trace in figure.data]
    traces = [trace for trace in traces if trace.get("visible", True) is True]
    height = float(layout.get("height", 340))
    horizontal, vertical = axes_of("x", traces, layout, WIDTH - 120), axes_of("y", traces, layout, height - 90)
    rows = rows_of(entries(traces), WIDTH - 20)
    maps = [trace for trace in traces if trace["type"] == "heatmap"]
    box = _box(horizontal, vertical, layout, height, len(rows), bool(maps))
    panes = _panes(traces, horizontal, vertical, box, layout)
    parts = [legend(rows, box.left, 0.0)]
    for number, ((across, down), pane) in enumerate(panes.items()):
        own = [trace for trace in traces if (trace["xaxis"], trace["yaxis"]) == (across, down)]
        lines = [one for one in layout.get("shapes", ()) if one["yref"].split()[0] == down]
        parts.append(_pane(pane, own, lines, layout, f"{identifier}-pane-{number}"))
    parts += [_annotation(one, box) for one in layout.get("annotations", ())]
    if maps:
        parts.append(colour_bar(colours_of(maps[0], layout), box, box.left + box.width + 10))
    style = {"font_family": "system-ui, sans-serif", "font_size": SIZE, "fill": "currentColor"}
    return element(
        "svg", "".join(parts), xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {WIDTH:g} {height:g}",
        id=identifier, role="img", aria_label=label, **style,
    )  # fmt: skip


def _box(
    horizontal: Mapping[str, Axis], vertical: Mapping[str, Axis], layout: Part, height: float, rows: int, maps: bool
) -> Box:
    """What is left of the figure beside labels, titles and legend."""
    left = 14 + max((width_of(label) for axis in vertical.values() for _, label in axis.labels), default=0.0) + TICK
    left += LINE + 4 if any(axis.title for axis in vertical.values()) else 0
    right = RIGHT_OF_MAP if maps else 18.0
    tall = [len(lines_of(label)) for axis in horizontal.values() for _, label in axis.labels if not axis.on_top]
    bottom = TICK + 8 + LINE * max(tall, default=0)
    bottom += LINE + 4 if any(axis.title for axis in horizontal.values()) else 0
    top = 10 + rows * (LINE + 3) + (LINE + 6 if layout.get("annotations") else 0)
    top += LINE + TICK if any(axis.on_top and axis.labels for axis in horizontal.values()) else 0
    top += LINE if maps else 0
    return Box(left, top, WIDTH - left - right, max(height - top - bottom, 40.0))


def _panes(
    traces: Sequence[Part], horizontal: Mapping[str, Axis], vertical: Mapping[str, Axis], box: Box, layout: Part
) -> dict[tuple[str, str], Pane]:
    pairs = dict.fromkeys((trace["xaxis"], trace["yaxis"]) for trace in traces)
    for name in vertical:  # panes without traces are drawn too
        anchor = layout[f"yaxis{name[1:]}"].get("anchor", f"x{name[1:]}")
        pairs.setdefault((anchor, name))
    return {(across, down): Pane(horizontal[across], vertical[down], box) for across, down in pairs}


def _pane(pane: Pane, traces: Sequence[Part], lines: Sequence[Part], layout: Part, clip: str) -> str:
    frame = {"x": pane.left, "y": pane.top, "width": pane.right - pane.left, "height": pane.bottom - pane.top}
    drawn = [(_may_leave(trace), _drawn(trace, pane, traces, layout)) for trace in traces]
    parts = [
        element("clipPath", element("rect", **frame), id=clip),
        _grid(pane),
        element("g", "".join(one for free, one in drawn if not free), clip_path=f"url(#{clip})"),
        *(one for free, one in drawn if free),
        *(_line(one, pane) for one in lines),
        element("path", d=f"M{pane.left:.1f} {pane.top:.1f}V{pane.bottom:.1f}H{pane.right:.1f}", **_stroke(0.7)),
        _labels(pane),
    ]
    return element("g", "".join(parts))


def _may_leave(trace: Part) -> bool:
    """Whether a trace is drawn beyond the axes too; bars are, whose texts stand outside."""
    return trace.get("cliponaxis") is False or trace["type"] == "bar"


def _drawn(trace: Part, pane: Pane, siblings: Sequence[Part], layout: Part) -> str:
    if trace["type"] == "heatmap":
        return heatmap(trace, pane, layout)
    if trace["type"] == "bar":
        own = [one for one in siblings if one["type"] == "bar"]
        return bars(trace, pane, _place(trace, own), len(own))
    place = _place(trace, siblings)
    return scatter(trace, pane, siblings[place - 1] if place else None)


def _place(trace: Part, among: Sequence[Part]) -> int:
    return next(i for i, one in enumerate(among) if one is trace)


def _line(shape: Part, pane: Pane) -> str:
    """A line across the pane, or down it where the shape spans the domain of the vertical axis."""
    if shape["yref"].endswith("domain"):
        d = f"M{float(pane.x([shape['x0']])[0]):.1f} {pane.top:.1f}V{pane.bottom:.1f}"
    else:
        d = f"M{pane.left:.1f} {float(pane.y([shape['y0']])[0]):.1f}H{pane.right:.1f}"
    line = shape.get("line", {})
    style = {"stroke": line.get("color", "currentColor"), "stroke_width": line.get("width", 2)}
    dashes = DASHES.get(line.get("dash", "solid"))
    return element("path", d=d, stroke_dasharray=dashes, **style)


def _grid(pane: Pane) -> str:
    across = _places(pane.horizontal, pane.left, pane.right) if pane.horizontal.grid else []
    down = _places(pane.vertical, pane.bottom, pane.top) if pane.vertical.grid else []
    d = "".join(f"M{x:.1f} {pane.top:.1f}V{pane.bottom:.1f}" for x in across)
    d += "".join(f"M{pane.left:.1f} {y:.1f}H{pane.right:.1f}" for y in down)
    return element("path", d=d, **_stroke(0.18)) if d else ""


def _labels(pane: Pane) -> str:
    parts, axis = [], pane.horizontal
    top = pane.top - TICK - 4 if axis.on_top else pane.bottom + TICK + SIZE
    free = -float("inf")
    for x, (_, label) in zip(_places(axis, pane.left, pane.right), axis.labels, strict=True):
        half = width_of(label) / 2 + 3
        if x - half >= free:
            parts.append(text(x, top, lines_of(label)))
            free = x + half
    for y, (_, label) in zip(_places(pane.vertical, pane.bottom, pane.top), pane.vertical.labels, strict=True):
        lines = lines_of(label)
        parts.append(text(pane.left - TICK - 2, y + SIZE / 3 - (len(lines) - 1) * LINE / 2, lines, "end"))
    if axis.title:
        below = LINE * max((len(lines_of(label)) for _, label in axis.labels), default=0)
        y = pane.bottom + below + LINE + TICK if not axis.on_top else pane.bottom + LINE
        parts.append(text((pane.left + pane.right) / 2, y, lines_of(axis.title)))
    if pane.vertical.title:
        middle = (pane.top + pane.bottom) / 2
        parts.append(text(12.0, middle, lines_of(pane.vertical.title), transform=f"rotate(-90 12 {middle:.1f})"))
    return "".join(parts)


def _places(axis: Axis, start: float, end: float) -> list[float]:
    scale = axis.scale
    return [start + (end - start) * (place - scale.low) / (scale.high - scale.low) for place, _ in axis.labels]


def _annotation(one: Part, box: Box) -> str:
    return text(box.left + box.width * one["x"], box.top + box.height * (1 - one["y"]) - 6, lines_of(one["text"]))


def _stroke(opacity: float) -> dict[str, object]:
    return {"stroke": "currentColor", "stroke_opacity": str(opacity), "stroke_width": 1, "fill": "none"}
