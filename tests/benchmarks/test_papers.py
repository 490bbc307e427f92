"""The gallery of the papers: what their data determine comes out, and what is off is said."""

import numpy as np
import pytest

from app.report.style import new_figure
from benchmarks.papers.__main__ import PAGE, wrong
from benchmarks.papers.gallery import Cell, Paper, Part, write
from benchmarks.papers.ghosh import designed, white_power


def test_white_noise_costs_what_the_paper_prints():
    phi = white_power()
    assert phi == pytest.approx(2.47, rel=0.01)
    assert 4000 * phi == pytest.approx(9880, rel=0.01)
    assert phi < white_power((0.0, 1.5, 5.5, 8.0))
    with pytest.raises(ArithmeticError, match="noise model"):
        white_power((0.0, 0.5, 1.0, 1.5))


def test_a_pair_of_points_of_table_1():
    assert designed(np.array([[0.0], [5.5]])).total_energy == pytest.approx(7904, rel=1e-3)


def test_a_page_has_tables_pictures_and_commands(tmp_path):
    figure = new_figure()
    figure.add_scatter(x=[0, 1], y=[1, 2], name="one")
    cells = (Cell("near", 100, 100.5), Cell("far", 100, 102.0), Cell("by draws", 100, 150.0, drawn=True))
    part = Part("Table", "python -m nothing", cells, (("picture", "A line", figure),))
    paper = Paper("Key2000", "A title", (part,))
    write([paper], tmp_path / "page.md", "# Head\n")
    text = (tmp_path / "page.md").read_text()
    assert "| near | 100 | 100.50 | +0.50 % |" in text
    assert "| by draws | 100 | 150 |  |" in text
    assert "![A line](page/picture.svg)" in text
    assert (tmp_path / "page" / "picture.svg").read_text().startswith("<svg ")
    assert wrong([paper]) == ["Key2000: far"]


def test_the_page_that_is_kept_names_every_paper():
    text = PAGE.read_text()
    for key in ("Ghosh2018", "Kergus2019", "Akcay2008", "Goos2014", "Cox2018"):
        assert f"[{key}]" in text
