"""The report of a whole chain shows the numbers of its documents."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from app.offline.loop import loop_of
from app.offline.subjects import model_in, plant_in
from app.offline.workplace import workplace
from app.report.chain.build import chain_report
from app.report.chain.documents import Chain
from app.report.document import Plot, Report
from app.report.figures.effects import confusability, ranking, visibility
from app.report.figures.misfit import misfit_by_band, misfit_by_point
from app.report.figures.misfit_map import MapRow, misfit_map
from app.report.figures.missing import missing
from app.report.figures.staircase import Step, staircase
from app.report.page import render


@pytest.fixture(scope="module")
def chain(repository: Path) -> Chain:
    file = repository / "examples" / "diagnose.yaml"
    content = yaml.safe_load(file.read_text())
    plant = plant_in(content)
    with workplace() as place:
        loop = loop_of(place, plant, content["experiments"], file.parent)
        first = model_in(content, plant, file.parent)
        found = loop.diagnose(first)
        second = loop.extend(first, {"effect": found.announced[0]})
        return loop.chain([first, second], [loop.compare(first), loop.compare(second)], [found])


@pytest.fixture(scope="module")
def report(chain: Chain) -> Report:
    return chain_report(chain)


def test_the_page_has_every_section_a_caption_and_a_table_for_every_plot(report: Report) -> None:
    titles = [section.title for section in report.sections]
    assert titles == [
        "How the error fell",
        "The plant: positioning stage",
        "The experiments",
        "Version 1: stated",
        "Version 1 against measurements",
        "What version 1 lacks",
        "Version 2: with cubic stiffness",
        "Version 2 against measurements",
    ]
    plots = [block for section in report.sections for block in section.blocks if isinstance(block, Plot)]
    assert all(plot.caption and plot.table.rows for plot in plots)
    assert all(len(row) == len(plot.table.columns) for plot in plots for row in plot.table.rows)
    page = render(report)
    assert page.count('role="img"') == len(plots) > 14


def test_the_staircase_falls_as_the_document_says(chain: Chain, report: Report) -> None:
    extension = chain.versions[1].extension
    assert extension is not None
    steps = chain.steps()
    assert [one.held_out for one in steps] == [extension.before.held_out, extension.after.held_out]
    shown = staircase(steps).figure.data
    np.testing.assert_allclose(shown[0].y[:2], [100 * extension.before.fitted, 100 * extension.after.fitted])
    assert report.facts[1].value == "cubic stiffness"


def test_a_staircase_without_held_out_data_has_one_curve() -> None:
    steps = [Step("a", 0.1, None, None), Step("b", 0.01, None, 0.3)]
    assert [trace.name for trace in staircase(steps).figure.data if trace.mode == "lines"] == ["fitted"]


def test_bars_are_chi_square_per_degree_of_freedom(chain: Chain) -> None:
    parts = chain.comparisons[0].document.parts
    for plot, tests in (
        (misfit_by_point(parts, chain.axes), [one.test for one in parts[0].by_point]),
        (misfit_by_band(parts), [one.test for one in parts[0].by_band]),
    ):
        expected = [(one.statistic or 0.0) / (one.degrees_of_freedom or 1.0) for one in tests]
        np.testing.assert_allclose(plot.figure.data[0].y, expected)
        assert [trace.name for trace in plot.figure.data] == ["fitted", "held out"]


def test_the_best_effect_stands_first_and_the_matrix_is_in_the_same_order(chain: Chain) -> None:
    diagnosis = chain.diagnoses[0]
    bars = ranking(diagnosis).figure.data[0]
    assert bars.y[0] == "cubic stiffness"
    assert bars.marker.color[0] != bars.marker.color[1]
    matrix = confusability(diagnosis)
    np.testing.assert_allclose(np.diagonal(matrix.figure.data[0].z), 1.0)
    assert matrix.table.rows[0][0] == "1 cubic stiffness"
    rows = visibility(diagnosis.visibility).table.rows
    assert len(rows) == len(diagnosis.visibility)


def test_what_the_best_effect_explains_lies_over_what_is_missing(chain: Chain) -> None:
    plot = missing(chain.diagnoses[0], chain.labels, chain.axes)
    curves = [trace for trace in plot.figure.data if trace.name in ("missing", "cubic stiffness")]
    for lacking, explained in zip(curves[::2], curves[1::2], strict=True):
        assert (lacking.name, explained.name) == ("missing", "cubic stiffness")
        assert np.corrcoef(lacking.y, explained.y)[0, 1] > 0.6


def row(bright: float, held_out: bool = False) -> MapRow:
    """One line of 5 among ones, at `bright` rad/s; every third line unexcited."""
    frequencies = np.arange(1.0, 101.0)
    residual = np.where(frequencies == bright, 5.0, 1.0).astype(complex)
    return MapRow(f"at {bright:g}", held_out, frequencies, residual, np.where(np.arange(100) % 3 == 2, 1, 0))


def test_the_map_is_bright_where_the_residual_is_large() -> None:
    plot = misfit_map([row(50.0), row(63.0), row(30.0, held_out=True)])
    titles = [note.text for note in plot.figure.layout.annotations]
    assert titles == [
        "fitted, excited lines",
        "fitted, unexcited lines",
        "held out, excited lines",
        "held out, unexcited lines",
    ]
    for heat, places in zip(plot.figure.data, ([50.0, None], [None, 63.0], [None], [30.0]), strict=True):
        for values, where in zip(np.asarray(heat.customdata), places, strict=True):
            if where is None:
                np.testing.assert_allclose(values[np.isfinite(values)], 1.0)
                continue
            cell = int(np.nanargmax(values))
            assert heat.x[cell] <= where / (2 * np.pi) <= heat.x[cell + 1]
    assert plot.table.rows[0][:2] == ("at 50", "fitted")


def test_a_cell_holds_the_root_mean_square_and_one_between_lines_its_nearest() -> None:
    bright = row(50.0)
    values = bright.cells(True, np.array([0.2, 0.5, 5.5, 6.9, 47.5, 52.5]))
    np.testing.assert_allclose(values[[1, 3]], 1.0)
    assert np.isnan(values[0])
    excited = (bright.classes == 0) & (bright.frequencies > 47.5) & (bright.frequencies < 52.5)
    count = int(excited.sum())
    assert values[4] == pytest.approx(np.sqrt((25 + count - 1) / count))
    between = MapRow("", False, np.array([1.0, 3.0, 5.0]), np.array([1.0, 2.0, 3.0]) + 0j, np.zeros(3, dtype=int))
    np.testing.assert_allclose(between.cells(True, np.array([0.9, 1.5, 1.9, 4.4, 4.9])), [1.0, 1.0, 2.0, 3.0])
