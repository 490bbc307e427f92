"""Bars, upright or lying, beside each other where there are several to a category."""

from typing import Any

import numpy as np

from app.report.svg.elements import SIZE, element, lines_of, text
from app.report.svg.pane import Pane, Part
from identification.arrays import FloatArray

SHARE = 0.8


def bars(trace: Part, pane: Pane, number: int, count: int) -> str:
    """A trace of the kind bar, the `number`-th of `count` of its axes."""
    upright = trace.get("orientation") != "h"
    across, along = ("x", "y") if upright else ("y", "x")
    axis = pane.horizontal if upright else pane.vertical
    width = float(trace.get("width") or SHARE / count)
    middle = axis.scale.coordinates(trace[across]) + (number - (count - 1) / 2) * width
    pixels = pane.x if upright else pane.y
    sides = [_raw(axis, pixels, middle + half * width) for half in (-0.5, 0.5)]
    ends = (pane.y if upright else pane.x)(trace[along])
    scale = (pane.vertical if upright else pane.horizontal).scale
    foot = float((pane.y if upright else pane.x)([0.0])[0]) if scale.kind == "linear" else _edge(pane, upright)
    parts = []
    for i in np.flatnonzero(np.isfinite(ends)).tolist():
        low, high = sorted((float(sides[0][i]), float(sides[1][i])))
        box = _box(upright, low, high, foot, float(ends[i]))
        title = element("title", _plain(pane.hover(trace.get("name") or "", trace["x"][i], trace["y"][i])))
        parts.append(element("rect", title, **box, **_paint(trace.get("marker", {}), i)))
        if trace.get("text") is not None:
            parts.append(_label(trace["text"][i], upright, low, high, float(ends[i])))
    return element("g", "".join(parts))


def _raw(axis: Any, pixels: Any, coordinates: FloatArray) -> FloatArray:
    """Pixels of coordinates of an axis, whose categories are numbers already."""
    if axis.scale.kind == "linear":
        return np.asarray(pixels(coordinates))
    first, second = pixels(axis.scale.categories[:1])[0], pixels(axis.scale.categories[-1:])[0]
    count = len(axis.scale.categories)
    step = (second - first) / (count - 1) if count > 1 else _only_step(axis, pixels, first)
    return np.asarray(first + step * coordinates)


def _only_step(axis: Any, pixels: Any, middle: float) -> float:
    """The width of the one category there is: the axis begins half a category before it."""
    owner = pixels.__self__
    return float(2 * (middle - (owner.left if pixels.__name__ == "x" else owner.top)))


def _edge(pane: Pane, upright: bool) -> float:
    return pane.bottom if upright else pane.left


def _box(upright: bool, low: float, high: float, foot: float, end: float) -> dict[str, float]:
    start, length = min(foot, end), abs(end - foot)
    if upright:
        return {"x": low, "y": start, "width": high - low, "height": length}
    return {"x": start, "y": low, "width": length, "height": high - low}


def _paint(marker: Part, i: int) -> dict[str, object]:
    colour, line = marker.get("color", "currentColor"), marker.get("line", {})
    width = line.get("width", 0)
    own = float(width if isinstance(width, int | float) else width[i])
    border = {"stroke": line.get("color"), "stroke_width": own} if own else {}
    return {"fill": colour if isinstance(colour, str) else colour[i], **border}


def _label(label: str, upright: bool, low: float, high: float, end: float) -> str:
    lines = lines_of(label)
    if upright:
        return text((low + high) / 2, end - 5, lines)
    return text(end + 5, (low + high) / 2 + SIZE / 3, lines, "start")


def _plain(said: str) -> str:
    return said.replace("&", "&amp;").replace("<", "&lt;")
