"""The look of all plots: colours that colour-blind readers can tell apart, text and grid left to the page's style."""

from collections.abc import Sequence
from textwrap import wrap

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from identification.arrays import FloatArray

# Okabe and Ito's palette, without those that vanish on a white or a dark page.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
NEUTRAL = "#808080"
SEQUENTIAL = "Cividis"  # made for colour-blind readers, dark to bright on light and dark pages
CLEAR = "rgba(0,0,0,0)"


def colour(index: int) -> str:
    """The colour of the index-th thing."""
    return PALETTE[index % len(PALETTE)]


def dash(index: int) -> str:
    """The line style of the index-th thing, so that colour is not the only difference."""
    return DASHES[index % len(DASHES)]


def faded(hexadecimal: str, opacity: float = 0.25) -> str:
    """A colour for areas."""
    red, green, blue = (int(hexadecimal[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"


def wrapped(text: str, width: int = 20) -> str:
    """A label in lines of at most so many characters."""
    return "<br>".join(wrap(text, width))


def new_figure(titles: Sequence[str] = ("",), heights: Sequence[float] | None = None, height: int = 340) -> go.Figure:
    """An empty figure with one row a title and a common horizontal axis, made for narrow and wide pages."""
    figure = make_subplots(
        rows=len(titles),
        cols=1,
        shared_xaxes=True,
        subplot_titles=list(titles) if any(titles) else None,
        row_heights=list(heights) if heights else None,
        vertical_spacing=min(0.09, 0.3 / len(titles)),
    )
    figure.update_layout(
        template="none",
        height=height,
        margin={"l": 12, "r": 12, "t": 28, "b": 12},
        paper_bgcolor=CLEAR,
        plot_bgcolor=CLEAR,
        font={"family": "system-ui, sans-serif", "size": 13, "color": NEUTRAL},
        legend={"orientation": "h", "x": 0, "xanchor": "left", "y": 1.02, "yanchor": "bottom", "bgcolor": CLEAR},
        hovermode="closest",
        dragmode=False,
        barmode="group",
    )
    axis: dict[str, object] = {
        "automargin": True,
        "showline": True,
        "linecolor": NEUTRAL,
        "gridcolor": faded(NEUTRAL, 0.3),
    }
    axis["title"] = {"font": {"size": 13}}
    figure.update_annotations(font_size=13)
    figure.update_xaxes(**axis, zeroline=False, ticks="outside", tickcolor=NEUTRAL)
    figure.update_yaxes(**axis, zeroline=False)
    return figure


def add_band(
    figure: go.Figure,
    x: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    hexadecimal: str,
    row: int,
    opacity: float = 0.3,
    group: str | None = None,
    show: bool = False,
) -> None:
    """The area between two curves, with the visibility of its legend group, named after it if it is to `show`."""
    common = {"x": x, "mode": "lines", "line": {"width": 0}, "hoverinfo": "skip", "legendgroup": group}
    figure.add_scatter(**common, y=lower, showlegend=False, row=row, col=1)
    area = {"fill": "tonexty", "fillcolor": faded(hexadecimal, opacity), "name": group, "showlegend": show}
    figure.add_scatter(**common, y=upper, **area, row=row, col=1)


def add_truth(figure: go.Figure, x: FloatArray, y: FloatArray, row: int, show: bool) -> None:
    """A broad pale line, to be drawn before what is held against it."""
    line = {"color": faded(NEUTRAL, 0.45), "width": 7}
    common = {"mode": "lines", "name": "truth", "legendgroup": "truth", "hoverinfo": "skip"}
    figure.add_scatter(x=x, y=y, line=line, showlegend=show, row=row, col=1, **common)
