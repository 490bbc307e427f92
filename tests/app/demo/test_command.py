"""`lpv-oed demo` leaves one offline page, the same for the same seed."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import application
from app.demo.report import demo_report
from app.report.document import Plot
from app.report.page import render
from tests.app.demo.conftest import Told

pytestmark = pytest.mark.xdist_group("demo")


def test_the_command_says_where_the_report_is_and_repeats_itself(told: Told, tmp_path: Path) -> None:
    result = CliRunner().invoke(application, ["demo", "--output", str(tmp_path / "out"), "--seed", "1"])
    assert result.exit_code == 0, result.output
    path = tmp_path / "out" / "report.html"
    assert str(path) in [line.strip() for line in result.output.splitlines()]
    assert path.stat().st_size < 1.5e6
    assert path.read_text(encoding="utf-8") == render(demo_report(told.story))


def test_a_folder_that_cannot_be_made_is_a_message(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    result = CliRunner().invoke(application, ["demo", "--output", str(tmp_path / "file" / "out")])
    assert result.exit_code == 1
    assert "Traceback" not in result.output
    assert isinstance(result.exception, SystemExit)


def test_an_unknown_effect_is_a_message(tmp_path: Path) -> None:
    result = CliRunner().invoke(application, ["demo", "--output", str(tmp_path), "--hidden", "goblin"])
    assert result.exit_code == 1
    assert "the stage cannot hide goblin" in result.output + result.stderr


def test_the_report_shows_every_step(told: Told) -> None:
    sections = demo_report(told.story).sections
    plots = [block for section in sections for block in section.blocks if isinstance(block, Plot)]
    shown = " ".join(plot.caption for plot in plots)
    for word in (
        "Input energy",
        "Spectrum",
        "period",
        "Frequency response",
        "95 % band",
        "Poles",
        "Standard deviation",
        "residuals divided",
        "Effects fitted",
        "missing from the frequency response",
        "each version",
    ):
        assert word in shown
    assert len(plots) >= 20


def test_the_report_names_no_time_and_no_place(told: Told) -> None:
    text = render(demo_report(told.story)).split("<script>")[0]
    assert not re.search(r"\b20\d\d-\d\d-\d\d\b|/home/|/tmp/|/root/", text)
