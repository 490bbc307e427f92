"""Curves, points, texts and error bars."""

from collections.abc import Iterator, Sequence
from itertools import repeat
from typing import Any

import numpy as np

from app.report.svg.elements import element, lines_of, text
from app.report.svg.marks import DASHES, mark, path
from app.report.svg.pane import Pane, Part
from identification.arrays import FloatArray

MOST_HOVERS = 400
STANDARD_SIZE = 6.0


def scatter(trace: Part, pane: Pane, before: Part | None) -> str:
    """What a trace of the kind scatter looks like; `before` is the trace up to which it may be filled."""
    mode = trace.get("mode") or "lines+markers"
    x, y = pane.x(trace["x"]), pane.y(trace["y"])
    parts = []
    if trace.get("fill") == "tonexty" and before is not None:
        parts.append(_area(x, y, pane.x(before["x"]), pane.y(before["y"]), trace.get("fillcolor", "none")))
    if trace.get("error_y"):
        parts.append(_errors(trace, pane, x))
    line = trace.get("line", {})
    if "lines" in mode and line.get("width", 2) > 0:
        parts.append(_line(x, y, line))
    if "markers" in mode:
        parts += _markers(trace, pane, x, y)
    if "text" in mode:
        parts += [text(float(a), float(b) - 6, lines_of(one)) for a, b, one in zip(x, y, trace["text"], strict=True)]
    return element("g", "".join(parts), opacity=trace.get("opacity"))


def _area(x: FloatArray, y: FloatArray, back_x: FloatArray, back_y: FloatArray, colour: str) -> str:
    outline = path(np.concatenate([x, back_x[::-1]]), np.concatenate([y, back_y[::-1]]))
    return element("path", d=f"{outline}Z", fill=colour, stroke="none") if outline else ""


def _line(x: FloatArray, y: FloatArray, line: Part) -> str:
    if line.get("shape") == "hv" and len(x) > 1:
        x, y = np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1]
    style = {"stroke": line.get("color", "currentColor"), "stroke_width": line.get("width", 2)}
    dashes = DASHES.get(line.get("dash", "solid"))
    return element("path", d=path(x, y), fill="none", stroke_linejoin="round", stroke_dasharray=dashes, **style)


def _markers(trace: Part, pane: Pane, x: FloatArray, y: FloatArray) -> Iterator[str]:
    marker = trace.get("marker", {})
    colours = _each(marker.get("color", "currentColor"), len(x))
    style = marker.get("symbol", "circle"), float(marker.get("size", STANDARD_SIZE))
    width = float(marker.get("line", {}).get("width", 0.0))
    said = len(x) <= MOST_HOVERS and trace.get("hoverinfo") != "skip"
    parts = []
    for i in np.flatnonzero(np.isfinite(x) & np.isfinite(y)).tolist():
        title = pane.hover(trace.get("name") or "", trace["x"][i], trace["y"][i]) if said else ""
        parts.append(mark(style[0], float(x[i]), float(y[i]), style[1], colours[i], width, title))
    yield element("g", "".join(parts), opacity=marker.get("opacity"))


def _errors(trace: Part, pane: Pane, x: FloatArray) -> str:
    error, values = trace["error_y"], np.asarray(trace["y"], dtype=float)
    above = np.asarray(error["array"], dtype=float)
    below = np.asarray(error.get("arrayminus", above), dtype=float)
    upper, lower = pane.y(values + above), pane.y(values - below)
    lower = np.where(np.isfinite(lower), lower, pane.bottom)
    bars = "".join(
        f"M{a:.1f} {u:.1f}V{b:.1f}" for a, u, b in zip(x, upper, lower, strict=True) if np.isfinite([a, u]).all()
    )
    colour = error.get("color", trace.get("marker", {}).get("color", "currentColor"))
    return element("path", d=bars, fill="none", stroke=colour, stroke_width=error.get("thickness", 2))


def _each(value: Any, count: int) -> Sequence[Any]:
    return list(repeat(value, count)) if isinstance(value, str) else list(value)
