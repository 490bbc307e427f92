"""Symbols, dashes and paths."""

import numpy as np

from app.report.svg.elements import element
from identification.arrays import FloatArray

DASHES = {"dash": "7 4", "dot": "2 3", "dashdot": "7 3 2 3", "longdash": "11 4", "longdashdot": "11 3 2 3"}
DIAGONAL = 0.7


def mark(symbol: str, x: float, y: float, size: float, colour: str, line: float, title: str = "") -> str:
    """A symbol of plotly's name around a place, with what it says when pointed at."""
    base, hollow = symbol.removesuffix("-open"), symbol.endswith("-open")
    r = size / 2
    paint = {"fill": "none" if hollow else colour, "stroke": colour if hollow or line else None}
    style = {**paint, "stroke_width": (line or 1.5) if paint["stroke"] else None}
    inside = element("title", _escaped(title)) if title else ""
    if base == "circle":
        return element("circle", inside, cx=x, cy=y, r=r, **style)
    if base in {"line-ns", "line-ew", "x-thin"}:
        style = {"stroke": colour, "stroke_width": line or 1.5, "fill": "none"}
    return element("path", inside, d=_outline(base, x, y, r), **style)


def _outline(base: str, x: float, y: float, r: float) -> str:
    d = DIAGONAL * r
    outlines = {
        "line-ns": f"M{x:.1f} {y - r:.1f}V{y + r:.1f}",
        "line-ew": f"M{x - r:.1f} {y:.1f}H{x + r:.1f}",
        "x-thin": f"M{x - d:.1f} {y - d:.1f}L{x + d:.1f} {y + d:.1f}M{x - d:.1f} {y + d:.1f}L{x + d:.1f} {y - d:.1f}",
        "diamond": f"M{x:.1f} {y - r:.1f}L{x + r:.1f} {y:.1f}L{x:.1f} {y + r:.1f}L{x - r:.1f} {y:.1f}Z",
    }
    square = f"M{x - d:.1f} {y - d:.1f}H{x + d:.1f}V{y + d:.1f}H{x - d:.1f}Z"
    return outlines.get(base, square)


def path(x: FloatArray, y: FloatArray) -> str:
    """Straight lines from place to place, interrupted where a number is missing."""
    x, y = _thinned(np.round(x, 1), np.round(y, 1))
    known = np.isfinite(x) & np.isfinite(y)
    parts, pen_down = [], False
    for across, down, there in zip(x.tolist(), y.tolist(), known.tolist(), strict=True):
        if there:
            parts.append(f"{'L' if pen_down else 'M'}{across:g} {down:g}")
        pen_down = there
    return "".join(parts)


def _thinned(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of places in the same tenth of a pixel column the first, lowest, highest and last; nothing else can be seen."""
    if len(x) < 2000 or not np.all(np.diff(x) >= 0):
        return x, y
    starts = np.flatnonzero(np.diff(np.floor(2 * x), prepend=-np.inf))
    kept = []
    for start, end in zip(starts, [*starts[1:], len(x)], strict=True):
        piece = y[start:end]
        known = np.nan_to_num(piece, nan=piece[np.isfinite(piece)].mean() if np.isfinite(piece).any() else 0.0)
        kept += sorted({start, start + int(known.argmin()), start + int(known.argmax()), end - 1})
    return x[kept], y[kept]


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
