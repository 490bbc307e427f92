"""Cells in colour, and the bar that says what the colours mean."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from plotly.colors import sample_colorscale

from app.report.svg.axes import Axis, edges
from app.report.svg.elements import SIZE, element, number_label, text
from app.report.svg.pane import Box, Pane, Part
from identification.arrays import FloatArray

BAR = 12
STEPS = 24


def colours_of(trace: Part, layout: Part) -> Part:
    """The scale, its ends and its bar: of the trace, or of the axis of colours that it shares."""
    shared = layout.get(trace.get("coloraxis", ""), {})
    low, high = shared.get("cmin", trace.get("zmin")), shared.get("cmax", trace.get("zmax"))
    values = np.asarray(trace["z"], dtype=float)
    return {
        "scale": shared.get("colorscale", trace.get("colorscale")),
        "low": float(np.nanmin(values)) if low is None else low,
        "high": float(np.nanmax(values)) if high is None else high,
        "bar": shared.get("colorbar", trace.get("colorbar", {})),
    }


def heatmap(trace: Part, pane: Pane, layout: Part) -> str:
    """A trace of the kind heatmap: a rectangle for each number."""
    values, colours = np.asarray(trace["z"], dtype=float), colours_of(trace, layout)
    shown = np.asarray(trace.get("customdata", values), dtype=float)
    across = pane.x(_edges(trace["x"], pane.horizontal, values.shape[1]))
    down = pane.y(_edges(trace["y"], pane.vertical, values.shape[0]))
    span = colours["high"] - colours["low"] or 1.0
    parts = []
    for r, c in np.argwhere(np.isfinite(values)):
        share = float(np.clip((values[r, c] - colours["low"]) / span, 0, 1))
        (left, right), (top, bottom) = sorted(across[[c, c + 1]]), sorted(down[[r, r + 1]])
        box = {"x": float(left), "y": float(top), "width": float(right - left), "height": float(bottom - top)}
        title = element("title", number_label(float(f"{shown[r, c]:.3g}")))
        parts.append(element("rect", title, fill=_colour(colours["scale"], share), **box))
    return element("g", "".join(parts), shape_rendering="crispEdges")


def _edges(values: Sequence[Any], axis: Axis, count: int) -> FloatArray:
    return edges(axis.scale.coordinates(values) if axis.scale.kind == "category" else values, count)


def colour_bar(colours: Part, box: Box, x: float) -> str:
    """A strip of the colours with ticks, right of the figure."""
    height = box.height / STEPS
    strip = [
        element(
            "rect", x=x, y=box.top + i * height, width=BAR, height=height + 0.5,
            fill=_colour(colours["scale"], 1 - (i + 0.5) / STEPS),
        )
        for i in range(STEPS)
    ]  # fmt: skip
    bar, span = colours["bar"], colours["high"] - colours["low"] or 1.0
    values = bar.get("tickvals") or np.linspace(colours["low"], colours["high"], 5).tolist()
    labels = bar.get("ticktext") or [number_label(float(f"{value:.3g}")) for value in values]
    ticks = [
        text(x + BAR + 5, box.top + box.height * (1 - (value - colours["low"]) / span) + SIZE / 3, [label], "start")
        for value, label in zip(values, labels, strict=True)
    ]
    title = bar.get("title", {}).get("text")
    return "".join([*strip, *ticks, text(x, box.top - 8, [title], "start") if title else ""])


def _colour(scale: object, share: float) -> str:
    return str(sample_colorscale(scale, [round(share, 3)])[0]).replace(" ", "")
