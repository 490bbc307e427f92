"""The axes of a figure of plotly: their kinds, ranges and ticks, found from layout and data."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from app.report.svg.scales import Scale, Tick, coordinates
from identification.arrays import FloatArray

Part = Mapping[str, Any]
PADDING = 0.05


@dataclass(frozen=True)
class Axis:
    """An axis with its scale, what it says, and the part of the figure (0 to 1) along which it lies."""

    scale: Scale
    title: str
    domain: tuple[float, float]
    grid: bool
    labels: tuple[Tick, ...]
    on_top: bool

    def place(self, values: Sequence[object] | FloatArray) -> FloatArray:
        """Places between 0 and 1 of the whole figure."""
        low, high = self.domain
        return np.asarray(low + (high - low) * self.scale.share(values))


def axes_of(letter: str, traces: Sequence[Part], layout: Part, pixels: float) -> dict[str, Axis]:
    """All axes of a direction ("x" or "y") by the names that traces give them, e.g. "x2"; `pixels`: of the figure."""
    settings = {_name(key): value for key, value in layout.items() if _is_axis(key, letter)}
    groups = {name: one.get("matches", name) for name, one in settings.items()}
    found = {}
    for name, own in settings.items():
        together = [other for other, group in groups.items() if group == groups[name]]
        members = [trace for trace in traces if trace.get(f"{letter}axis", letter) in together]
        lines = [s for s in layout.get("shapes", ()) if s.get(f"{letter}ref") in together]
        scale = _scale(letter, own, members, lines)
        domain = tuple(own.get("domain", (0.0, 1.0)))
        most = own.get("nticks") or _fitting(letter, pixels * (domain[1] - domain[0]))
        found[name] = Axis(
            scale,
            own.get("title", {}).get("text") or "",
            (float(domain[0]), float(domain[1])),
            own.get("showgrid", True),
            _labels(own, scale, most) if own.get("showticklabels", True) else (),
            own.get("side") == "top",
        )
    return found


def _fitting(letter: str, pixels: float) -> int:
    return max(int(pixels / (90 if letter == "x" else 42)), 2)


def _labels(own: Part, scale: Scale, most: int) -> tuple[Tick, ...]:
    low, high = sorted((scale.low, scale.high))
    if own.get("tickvals") is None:
        ticks = scale.ticks(most)
    else:
        places = scale.coordinates(own["tickvals"]) if scale.kind == "log" else own["tickvals"]
        ticks = [(float(place), str(label)) for place, label in zip(places, own["ticktext"], strict=True)]
    slack = 1e-9 * (high - low)
    return tuple(tick for tick in ticks if low - slack <= tick[0] <= high + slack)


def _scale(letter: str, own: Part, traces: Sequence[Part], lines: Sequence[Part]) -> Scale:
    kind, names = own.get("type"), _categories(letter, own, traces)
    if kind is None and names:
        kind = "category"
    kind = kind or "linear"
    if own.get("range") is not None:
        low, high = (float(end) for end in own["range"])
        return Scale(kind, low, high, names)
    if kind == "category":
        low, high = -0.5, max(len(names), 1) - 0.5
    else:
        ends = [coordinates(values, kind) for values in _values(letter, traces, lines, kind)]
        low, high = _range(letter, np.concatenate(ends) if ends else np.zeros(0), own, _has_marks(traces))
    return Scale(kind, high, low, names) if own.get("autorange") == "reversed" else Scale(kind, low, high, names)


def _range(letter: str, numbers: FloatArray, own: Part, marks: bool) -> tuple[float, float]:
    finite = numbers[np.isfinite(numbers)]
    if not len(finite):
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    zero = own.get("rangemode") == "tozero" and own.get("type") != "log"
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low <= 1e-9 * max(abs(low), abs(high)):  # a constant stands in the middle of what is about its size
        half = 0.5 if own.get("type") == "log" else abs(high) / 2 or 1.0
        return low - half, high + half
    pad = PADDING * (high - low) if letter == "y" or marks else 0.0
    return (low if zero and low == 0 else low - pad), (high if zero and high == 0 else high + pad)


def _values(
    letter: str, traces: Sequence[Part], lines: Sequence[Part], kind: str
) -> Iterator[Sequence[Any] | FloatArray]:
    for trace in traces:
        if trace["type"] == "heatmap":
            yield edges(trace[letter], len(trace["z"][0]) if letter == "x" else len(trace["z"]))
            continue
        values = trace[letter]
        yield values
        upright = trace.get("orientation") != "h"
        if trace["type"] == "bar" and kind == "linear":
            if (letter == "y") == upright:
                yield [0.0]
            elif trace.get("width") is not None:
                yield np.add.outer([-0.5, 0.5], np.zeros(len(values))).ravel() * trace["width"] + np.tile(values, 2)
        error = trace.get("error_y") if letter == "y" else None
        if error:
            above, below = np.asarray(error["array"]), np.asarray(error.get("arrayminus", error["array"]))
            yield np.concatenate([np.asarray(values) + above, np.asarray(values) - below])
    yield from ([line[f"{letter}0"], line[f"{letter}1"]] for line in lines)


def edges(values: Sequence[float] | FloatArray, count: int) -> FloatArray:
    """Edges (count + 1,) of cells that are given by their edges or by their middles."""
    given = np.asarray(values, dtype=float)
    if len(given) == count + 1:
        return given
    half = np.diff(given).mean() / 2 if count > 1 else 0.5
    return np.append(given - half, given[-1] + half)


def _categories(letter: str, own: Part, traces: Sequence[Part]) -> tuple[str, ...]:
    if own.get("categoryarray") is not None:
        return tuple(str(one) for one in own["categoryarray"])
    values = list(chain.from_iterable(trace[letter] for trace in traces))
    textual = own.get("type") == "category" or any(isinstance(one, str) for one in values)
    return tuple(dict.fromkeys(str(one) for one in values)) if textual else ()


def _has_marks(traces: Sequence[Part]) -> bool:
    return any(trace["type"] == "scatter" and "markers" in (trace.get("mode") or "") for trace in traces)


def _is_axis(key: str, letter: str) -> bool:
    return key.startswith(f"{letter}axis") and (key[5:] or "1").isdigit()


def _name(key: str) -> str:
    return key.replace("axis", "")
