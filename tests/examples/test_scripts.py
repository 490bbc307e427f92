"""The example scripts run and reach what they ask for."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.patience import PATIENCE


def shown(repository: Path, name: str, *arguments: str) -> str:
    script = repository / "examples" / name
    finished = subprocess.run(
        [sys.executable, script, *arguments],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE,
        env=_environment(repository),
    )
    assert finished.stderr == ""
    return finished.stdout


def _environment(repository: Path) -> dict[str, str]:
    return {"PYTHONPATH": str(repository), "OPENBLAS_NUM_THREADS": "1", "PYTHONIOENCODING": "utf-8", "PATH": ""}


def test_two_stages_reach_what_was_asked(repository: Path) -> None:
    text = shown(repository, "two_stage.py")
    first, both = ([float(x) for x in numbers.split()] for numbers in re.findall(r"asked: \[(.*?)\]", text))
    assert max(first) > 120
    assert max(both) < 105
    assert "converged" in text


def test_the_response_is_as_accurate_as_asked(repository: Path) -> None:
    text = shown(repository, "response_accuracy.py")
    assert text.startswith("converged")
    widths = [float(x) for x in re.findall(r"known to ±([\d.]+) %", text)]
    assert max(widths) == pytest.approx(1.0, abs=0.01)


def test_what_is_missing_is_found_and_drawn(repository: Path, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    lines = shown(repository, "missing_effect.py", str(path)).splitlines()
    assert lines[1].startswith("Coulomb friction: ")
    errors = [float(line.rpartition(" ")[2]) for line in lines[:2]]
    assert errors[1] < 0.3 * errors[0]
    page = path.read_text()
    for title in ("How the error fell", "At first", "What is missing", "In the end"):
        assert f"<h2>{title}</h2>" in page
    assert page.count('role="img"') == 1 + 4 + 4 + 4
