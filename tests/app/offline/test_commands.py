"""Commands without a server: request files in, results out, the same as over HTTP."""

import html
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from app.cli import application
from app.files import csv_writer
from app.files.readers import read_tables
from app.report.numbers import significant
from tests.support import responses
from tests.support.paper import DEVIATIONS, GRID, NOISE_VARIANCE, PLANT, THETA, fir, played

RUNNER = CliRunner()


def run(command: str, file: Path, *options: str) -> tuple[int, str]:
    result = RUNNER.invoke(application, [command, str(file), "--output", str(file.parent / "results"), *options])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output + result.stderr


@pytest.fixture
def designing(tmp_path: Path) -> dict[str, object]:
    return {
        "plant": PLANT,
        "model": {"theta": THETA, "noiseVariance": NOISE_VARIANCE},
        "design": {
            "operatingPoints": GRID,
            "targets": [{"kind": "parameter_deviation", "standardDeviations": DEVIATIONS}],
            "spectrumFamily": fir(10),
            "samples": 1000,
        },
    }


def test_design_finds_what_the_paper_has(tmp_path: Path, designing: dict[str, object]) -> None:
    file = tmp_path / "request.yaml"
    designing["signals"] = {"samples": 100, "periods": 10}
    file.write_text(yaml.safe_dump(designing))
    code, output = run("design", file, "--report", str(tmp_path / "report.html"))
    assert code == 0, output
    design = json.loads((tmp_path / "results" / "design.json").read_text())
    assert design["totalEnergy"] == pytest.approx(3510.4, rel=1e-3)
    signals = json.loads((tmp_path / "results" / "signals.json").read_text())
    for signal in signals["signals"]:
        (samples,) = read_tables((tmp_path / "results" / f"signal-{signal['index']}.csv").read_bytes(), "csv")
        assert np.sum(samples.column("input").values ** 2) == pytest.approx(signal["energy"])
    assert "3510" in output
    report = (tmp_path / "report.html").read_text()
    for shown in ("Input energy at each", "Spectrum of the input", "no design can need less than", "One period of the"):
        assert shown in report
    expected = design["expectedStandardDeviations"]
    for name, asked, after in zip(design["parameterNames"], DEVIATIONS, expected, strict=True):
        numbers = rf"{re.escape(name)}</th>\s*<td>{significant(asked)}</td>\s*<td>{significant(after)}</td>"
        assert re.search(numbers, report), name


def test_the_report_of_what_cannot_be_says_what_stands_in_the_way(tmp_path: Path, designing: dict[str, Any]) -> None:
    designing["design"]["energyCaps"] = {"default": 1e-3}
    file = tmp_path / "request.yaml"
    file.write_text(yaml.safe_dump(designing))
    code, output = run("design", file, "--report", str(tmp_path / "report.html"))
    assert code == 3, output
    outcome = json.loads((tmp_path / "results" / "design.json").read_text())["outcome"]
    report = (tmp_path / "report.html").read_text()
    assert outcome["advice"] in html.unescape(report)
    assert "Standard deviation of each parameter" not in report


def test_identify_reads_files_and_design_takes_its_model(tmp_path: Path, designing: dict[str, object]) -> None:
    generator, experiments = np.random.default_rng(1), []
    for point in (0.0, 4.0, 8.0):
        u = generator.normal(size=600)
        columns = {"time": np.arange(600.0), "input": u, "output": played(point, u, generator)}
        (tmp_path / f"at-{point:g}.csv").write_bytes(csv_writer.write(columns))
        experiments.append({"file": f"at-{point:g}.csv", "operatingPoint": [point]})
    inline = {"kind": "timeRecord", "operatingPoint": [2.0], "sampleTimeSeconds": 1, "input": u.tolist()}
    experiments.append({**inline, "output": played(2.0, u, generator).tolist()})
    estimators = {"localEstimator": {"kind": "prediction_error"}, "lpvEstimator": {"kind": "joint_likelihood"}}
    file = tmp_path / "measured.json"
    file.write_text(json.dumps({"plant": PLANT, "experiments": experiments, "model": estimators}))
    code, output = run("identify", file, "--report", str(tmp_path / "report.html"))
    assert code == 0, output
    assert "Version 1: identified" in (tmp_path / "report.html").read_text()
    model = json.loads((tmp_path / "results" / "model.json").read_text())
    np.testing.assert_array_less(abs(np.array(model["theta"]) - THETA), 5 * np.array(model["standardDeviations"]))
    assert model["experimentIds"] == ["experiment1", "experiment2", "experiment3", "experiment4"]
    with np.load(tmp_path / "results" / "model.npz") as arrays:
        np.testing.assert_array_equal(arrays["theta"], model["theta"])
    second = tmp_path / "second.yaml"
    prior = {**designing["design"], "usePriorInformation": True}  # type: ignore[dict-item]
    second.write_text(yaml.safe_dump({**designing, "model": "results/model.json", "design": prior}))
    code, output = run("design", second)
    assert code == 0, output
    assert json.loads((tmp_path / "results" / "design.json").read_text())["totalEnergy"] < 3600


def test_identify_finds_state_space_models_too(tmp_path: Path) -> None:
    experiments = []
    for point in responses.POINTS:
        data = responses.measured(point)
        content = responses.npz(omega=data.frequencies, response=data.response, ts=1.0)
        (tmp_path / f"at-{point:g}.npz").write_bytes(content)
        experiments.append({"file": f"at-{point:g}.npz", "operatingPoint": [point]})
    estimators = {"parametricEstimator": {"kind": "parametric_subspace"}}
    estimators["subspaceEstimator"] = {"kind": "frequency_subspace"}
    file = tmp_path / "measured.json"
    file.write_text(json.dumps({"plant": responses.PLANT, "experiments": experiments, "model": estimators}))
    code, output = run("identify", file)
    assert code == 0, output
    model = json.loads((tmp_path / "results" / "model.json").read_text())
    assert max(error["relativeError"] for error in model["stateSpace"]["errors"]) < 1e-9
    with np.load(tmp_path / "results" / "model.npz") as arrays:
        assert (arrays["a"].shape, arrays["b4"].shape) == ((2, 3, 3), (3, 2))
        assert abs(np.linalg.eigvals(arrays["a"][0])).max() < 1


BAD = {
    "no mapping": ("[1, 2]", "mapping"),
    "no yaml": ("{", "neither YAML nor JSON"),
    "no plant": ("model: {}", "/plant: plant is missing"),
    "unknown field": ("plant: {name: x, colour: red}", "/plant/colour"),
    "no experiments": (yaml.safe_dump({"plant": PLANT}), "/experiments: experiments is missing"),
    "missing file": (
        yaml.safe_dump({"plant": PLANT, "experiments": [{"file": "no.csv", "operatingPoint": [1.0]}]}),
        "/experiments/0/file",
    ),
    "code": ("!!python/object/apply:os.system ['true']", "neither YAML nor JSON"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_request_files_say_where(tmp_path: Path, name: str) -> None:
    content, expected = BAD[name]
    file = tmp_path / "request.yaml"
    file.write_text(content)
    code, output = run("identify", file)
    assert code == 1
    assert expected in output.replace("\n", "")
    assert "Traceback" not in output


def test_exponents_without_a_point_are_numbers(tmp_path: Path, designing: dict[str, object]) -> None:
    text = yaml.safe_dump(designing).replace("noiseVariance: 0.5", "noiseVariance: 5e-1")
    file = tmp_path / "request.yaml"
    file.write_text(text)
    code, output = run("design", file)
    assert code == 0, output


@pytest.mark.parametrize(("command", "result"), [("identify", "model.json"), ("design", "design.json")])
def test_the_examples_run(tmp_path: Path, repository: Path, command: str, result: str) -> None:
    file = repository / "examples" / f"{command}.yaml"
    done = RUNNER.invoke(application, [command, str(file), "--output", str(tmp_path)])
    assert done.exit_code == 0, done.stderr
    assert json.loads((tmp_path / result).read_text())["outcome"]["status"] == "converged"
