"""compare, diagnose and extend on the example of the repository, and on requests with mistakes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from app.cli import application

RUNNER = CliRunner()


def run(*words: str | Path) -> tuple[int, str]:
    result = RUNNER.invoke(application, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output + result.stderr


@pytest.fixture(scope="session")
def example(repository: Path) -> Path:
    return repository / "examples" / "diagnose.yaml"


def changed(example: Path, folder: Path, **sections: Any) -> Path:
    """The example with other sections, its data files where they are."""
    content = {**yaml.safe_load(example.read_text()), **sections}
    for one in content["experiments"]:
        one["file"] = str(example.parent / one["file"])
    file = folder / "request.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


def test_compare_shows_the_failure_and_draws_it(example: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    code, output = run("compare", example, "-o", tmp_path, "--report", report)
    assert code == 0, output
    found = json.loads((tmp_path / "comparison.json").read_text())
    assert [one["data"] for one in found["experiments"]] == ["fitted"] * 4 + ["heldOut"]
    assert all(part["lackOfFit"]["pValue"] < 1e-9 for part in found["parts"])
    with np.load(tmp_path / "comparison.npz") as arrays:
        assert len(arrays["residual4"]) == len(arrays["frequenciesRadPerSecond4"])
    page = report.read_text()
    assert "Version 1 against measurements" in page
    assert "http://" not in page.split("</head>")[0]


def test_diagnose_finds_the_effect_and_adds_it(example: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.html"
    code, output = run("diagnose", example, "--add", "-o", tmp_path, "--report", report)
    assert code == 0, output
    assert json.loads((tmp_path / "diagnosis.json").read_text())["announced"] == ["cubic_stiffness"]
    errors = json.loads((tmp_path / "model.json").read_text())["extension"]
    assert errors["after"]["heldOut"] < 0.4 * errors["before"]["heldOut"]
    page = report.read_text()
    for title in ("How the error fell", "What version 1 lacks", "Version 2: with cubic stiffness"):
        assert title in page


def test_extend_adds_what_it_is_told_and_its_model_is_where_the_next_begins(example: Path, tmp_path: Path) -> None:
    code, output = run("extend", example, "-o", tmp_path)
    assert code == 0, output
    model = json.loads((tmp_path / "model.json").read_text())
    assert [one["kind"] for one in model["effects"]] == ["cubic_stiffness"]
    assert model["parentId"] == "model"
    again = changed(example, tmp_path, model="model.json", diagnose={"effects": ["cubic_stiffness", "delay"]})
    code, output = run("diagnose", again, "-o", tmp_path / "again")
    assert code == 0, output
    assert json.loads((tmp_path / "again" / "diagnosis.json").read_text())["verdict"] == "nothingMissing"


@pytest.mark.parametrize(
    ("command", "sections", "said"),
    [
        ("diagnose", {"diagnose": {"effects": ["goblin"]}}, "/effects/0: there is no effect goblin"),
        ("extend", {"extend": {}}, "/extend/effect"),
        ("extend", {"extend": {"effect": "goblin"}}, "there is no effect goblin"),
        ("compare", {"model": "nowhere.json"}, "/model: there is no file"),
        ("compare", {"compare": {"meanValue": 3}}, "/compare/meanValue"),
    ],
)
def test_a_mistake_is_named(example: Path, tmp_path: Path, command: str, sections: dict[str, Any], said: str) -> None:
    code, output = run(command, changed(example, tmp_path, **sections), "-o", tmp_path)
    assert code == 1
    assert said in output.replace("\n", " ")


def test_marks_of_held_out_experiments_are_checked(example: Path, tmp_path: Path) -> None:
    experiments = yaml.safe_load(example.read_text())["experiments"]
    all_held_out = [{**one, "heldOut": True} for one in experiments]
    code, output = run("compare", changed(example, tmp_path, experiments=all_held_out), "-o", tmp_path)
    assert (code, "all experiments are held out" in output) == (1, True)
    odd = [{**experiments[0], "heldOut": "perhaps"}, *experiments[1:]]
    code, output = run("compare", changed(example, tmp_path, experiments=odd), "-o", tmp_path)
    assert (code, "/experiments/0/heldOut" in output) == (1, True)
