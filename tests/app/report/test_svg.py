"""Pictures say what their numbers say: places, lengths and colours are read back out of the SVG."""

import re
from collections.abc import Iterator
from xml.etree import ElementTree as Tree

import numpy as np
import plotly.graph_objects as go
import pytest

from app.report.style import add_band, new_figure
from app.report.svg.draw import draw
from app.report.svg.scales import Scale

SVG = "{http://www.w3.org/2000/svg}"


def parsed(figure: go.Figure) -> Tree.Element:
    return Tree.fromstring(draw(figure, "plot-1", "a figure"))


def every(root: Tree.Element, tag: str) -> list[Tree.Element]:
    return list(root.iter(SVG + tag))


def numbers(element: Tree.Element, *names: str) -> tuple[float, ...]:
    return tuple(float(element.get(name, "nan")) for name in names)


def texts(root: Tree.Element) -> list[str]:
    return ["".join(one.itertext()) for one in every(root, "text")]


def pixels_of_labels(root: Tree.Element, coordinate: str) -> dict[str, float]:
    return {"".join(one.itertext()): float(one.get(coordinate, "nan")) for one in every(root, "text")}


def vertices(path: str) -> Iterator[tuple[float, float]]:
    for across, down in re.findall(r"[ML]([-\d.]+) ([-\d.]+)", path):
        yield float(across), float(down)


def test_points_on_logarithmic_axes_stand_where_the_ticks_say() -> None:
    figure = new_figure()
    figure.add_scatter(x=[1.0, 10.0, 1000.0], y=[1e-4, 1e-2, 1e-3], mode="markers", name="measured")
    figure.update_xaxes(type="log", title="frequency (Hz)")
    figure.update_yaxes(type="log", title="gain (mm/N)")
    root = parsed(figure)
    across, down = pixels_of_labels(root, "x"), pixels_of_labels(root, "y")
    circles = [numbers(one, "cx", "cy") for one in every(root, "circle")]
    np.testing.assert_allclose([x for x, _ in circles], [across["1"], across["10"], across["1000"]], atol=0.2)
    middles = np.array([down["10⁻⁴"], down["0.01"], down["0.001"]])
    np.testing.assert_allclose(np.ptp([y - m for (_, y), m in zip(circles, middles, strict=True)]), 0.0, atol=0.2)
    assert circles[1][1] < circles[0][1]  # up is more
    titles = ["".join(one.itertext()) for one in every(root, "title")]
    assert titles[1] == "measured\nfrequency (Hz): 10\ngain (mm/N): 0.01"


def test_bars_are_as_long_as_their_values_and_stand_beside_each_other() -> None:
    figure = new_figure()
    figure.add_bar(x=["a", "b"], y=[1.0, -2.0], name="one")
    figure.add_bar(x=["a", "b"], y=[3.0, 4.0], name="two")
    boxes = [numbers(one, "x", "y", "width", "height") for one in every(parsed(figure), "rect") if len(one)]
    heights = np.array([box[3] for box in boxes])
    np.testing.assert_allclose(heights / heights[0], [1, 2, 3, 4], rtol=0.01)
    foot = boxes[0][1] + boxes[0][3]
    assert boxes[1][1] == pytest.approx(foot, abs=0.2)  # a negative one hangs
    assert boxes[2][0] == pytest.approx(boxes[0][0] + boxes[0][2], abs=0.2)
    assert boxes[1][0] > boxes[2][0]


def test_lying_bars_in_reversed_order_go_downwards_with_their_texts() -> None:
    figure = new_figure()
    figure.add_bar(x=[5.0, 2.0], y=["first", "second<br>of all"], orientation="h", text=["5 N", "2 N"])
    figure.update_yaxes(autorange="reversed")
    root = parsed(figure)
    first, second = (numbers(one, "y", "width") for one in every(root, "rect") if len(one))
    assert first[0] < second[0]
    assert first[1] / second[1] == pytest.approx(2.5, rel=0.01)
    assert {"5 N", "2 N", "first", "secondof all"} <= set(texts(root))


def test_only_one_category_fills_its_axis() -> None:
    figure = new_figure()
    figure.add_bar(x=["alone"], y=[2.0])
    (box,) = (numbers(one, "x", "width") for one in every(parsed(figure), "rect") if len(one))
    assert box[1] > 400


def test_cells_have_the_colours_of_the_scale_and_none_where_no_number_is() -> None:
    figure = new_figure()
    cells = [[0.0, 1.0], [float("nan"), 0.5]]
    figure.add_heatmap(x=[0, 1], y=[0, 1], z=cells, colorscale=[[0, "#000000"], [1, "#ffffff"]])
    drawn = [one for one in every(parsed(figure), "rect") if len(one)]
    assert [one.get("fill") for one in drawn] == ["rgb(0,0,0)", "rgb(255,255,255)", "rgb(128,128,128)"]
    lower, upper = numbers(drawn[0], "y")[0], numbers(drawn[2], "y")[0]
    assert upper < lower


def test_an_area_lies_between_its_two_curves_and_a_gap_stays_a_gap() -> None:
    figure = new_figure()
    x = np.array([0.0, 1.0, 2.0])
    add_band(figure, x, np.array([1.0, 1.0, 1.0]), np.array([2.0, 3.0, 2.0]), "#0072B2", 1)
    figure.add_scatter(x=[0.0, 1.0, 2.0, 3.0], y=[1.0, None, 2.0, 3.0], mode="lines")
    paths = [one for one in every(parsed(figure), "path") if one.get("d", "").startswith("M")]
    area = next(one for one in paths if one.get("fill", "").startswith("rgba"))
    corners = list(vertices(area.get("d", "")))
    assert len(corners) == 6
    assert corners[1][1] < corners[0][1] < corners[-1][1]
    assert any(one.get("d", "").count("M") == 2 for one in paths)


def test_constants_zeros_and_nothing_at_all_have_axes() -> None:
    for values in ([7.0, 7.0], [0.0, 0.0], []):
        for kind in ("linear", "log"):
            figure = new_figure()
            figure.add_scatter(x=list(range(len(values))), y=values, mode="lines+markers")
            figure.update_yaxes(type=kind)
            text = draw(figure, "plot-1", "flat")
            assert "nan" not in text
            assert "inf" not in text


def test_long_curves_keep_their_extremes() -> None:
    figure = new_figure()
    y = np.zeros(50_000)
    y[31_234] = 1.0
    figure.add_scatter(x=np.arange(50_000), y=y, mode="lines")
    text = draw(figure, "plot-1", "long")
    assert len(text) < 100_000
    curve = max((one.get("d", "") for one in every(Tree.fromstring(text), "path")), key=len)
    heights = [down for _, down in vertices(curve)]
    assert max(heights) - min(heights) > 150


@pytest.mark.parametrize(
    ("scale", "labels"),
    [
        (Scale("linear", 0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1"]),
        (Scale("linear", -3e-5, 3e-5), ["−3·10⁻⁵", "−2·10⁻⁵", "−10⁻⁵", "0", "10⁻⁵", "2·10⁻⁵", "3·10⁻⁵"]),
        (Scale("log", 0.0, 3.0), ["1", "10", "100", "1000"]),
        (Scale("log", -0.1, 1.1), ["1", "2", "5", "10"]),
        (Scale("log", 2.0, 2.1), ["100", "110", "120"]),
    ],
)
def test_ticks_are_round(scale: Scale, labels: list[str]) -> None:
    assert [label for _, label in scale.ticks(6)] == labels


def test_cells_over_categories_and_a_line_down_the_pane():
    figure = new_figure()
    figure.add_heatmap(z=[[1.0, 2.0], [3.0, None]], x=["a", "b"], y=["c", "d"], zmin=0, zmax=3, colorscale="Viridis")
    cells = [rect for rect in every(parsed(figure), "rect") if rect.find(SVG + "title") is not None]
    places = [numbers(rect, "x", "y", "width") for rect in cells]
    assert len(places) == 3
    assert places[1][0] - places[0][0] == pytest.approx(places[0][2], abs=0.2)
    assert places[2][1] < places[0][1]
    lined = new_figure()
    lined.add_scatter(x=[0.0, 10.0], y=[0.0, 1.0])
    plain = len(every(parsed(lined), "path"))
    lined.add_vline(x=5.0)
    down = every(parsed(lined), "path")
    assert len(down) == plain + 1
    assert any(re.fullmatch(r"M[\d.]+ [\d.]+V[\d.]+", path.get("d", "")) for path in down)
