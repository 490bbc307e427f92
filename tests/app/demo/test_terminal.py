"""Steps and figures reach the reader on a terminal and in a pipe."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from app.demo.charts import bar, shaded, sparkline
from app.demo.run import STEPS
from app.demo.terminal import Terminal
from app.report.document import Table
from app.report.figures.misfit_map import MapRow
from tests.app.demo.conftest import Told


@pytest.mark.xdist_group("demo")
def test_a_pipe_gets_steps_tables_and_figures(told: Told) -> None:
    for step in range(1, STEPS):
        assert f"[{step}/{STEPS}]" in told.shown
    assert "No design can need less than" in told.shown
    assert "held out: 0.27 m, 10 N" in told.shown
    assert "▓██" in told.shown
    assert "which is what the plant hides" in " ".join(told.shown.split())
    assert "\x1b" not in told.shown
    assert max(map(len, told.shown.splitlines())) <= 100


def test_what_is_in_brackets_is_text_not_markup() -> None:
    console = Console(file=io.StringIO(), width=60)
    Terminal(console, 1).table(Table(("name",), (("b0[1]",), ("a[bold]",))))
    assert isinstance(console.file, io.StringIO)
    assert "b0[1]" in console.file.getvalue()
    assert "a[bold]" in console.file.getvalue()


@given(st.floats(-1.0, 2.0), st.integers(1, 60))
def test_a_bar_never_leaves_its_width(share: float, width: int) -> None:
    assert len(bar(share, width)) <= width


def test_bars_and_sparklines_grow_with_their_values() -> None:
    assert [bar(share, 4) for share in (0.0, 0.5, 0.53125, 1.0)] == ["", "██", "██▏", "████"]
    assert sparkline([0.0, 1.0, 4.0, 8.0]) == "▁▂▅█"
    assert sparkline([0.0, 0.0]) == "▁▁"


def test_the_map_is_dark_where_the_residual_is_large() -> None:
    frequencies = np.geomspace(1.0, 100.0, 200)
    residual = np.where(frequencies > 10.0, 20.0, 0.5).astype(complex)
    row = MapRow("one", False, frequencies, residual, np.zeros(200, dtype=int))
    assert shaded(row, 1.0, 100.0, 20) == " " * 10 + "█" * 10
