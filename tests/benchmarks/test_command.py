"""What the studies share on the command line."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.command import command_line, print_table, write_json


def test_only_the_options_that_a_study_has() -> None:
    every = command_line("purpose", runs=7, seed=3, page=True).parse_args(["--workers", "1", "--page", "a.html"])
    assert (every.runs, every.seed, every.workers, every.page, every.output) == (7, 3, 1, Path("a.html"), None)
    assert vars(command_line("purpose").parse_args([])) == {"output": None}


def test_figures_are_numbers_or_there_is_no_file(tmp_path: Path) -> None:
    file = tmp_path / "figures.json"
    write_json({"Größe": np.float64(1.5)}, None)
    write_json({"Größe": [np.float64(1.5), np.int64(2)]}, file)
    assert json.loads(file.read_text(encoding="utf-8")) == {"Größe": [1.5, 2]}
    with pytest.raises(ValueError, match="JSON compliant"):
        write_json({"mean": float("nan")}, file)


def test_a_table_is_aligned_and_leaves_out_what_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    print_table([{"name": "a", "x": 1.23456789}, {"name": "longer", "y": [1, 2.5]}, {"name": "b", "x": 10}])
    assert capsys.readouterr().out.splitlines() == [
        "name          x       y",
        "a       1.23457",
        "longer           1, 2.5",
        "b            10",
    ]
