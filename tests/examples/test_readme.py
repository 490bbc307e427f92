"""The tour in README.md is true: its code runs as it stands there."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.patience import PATIENCE
from tests.support.server import Server


def blocks(repository: Path, language: str) -> list[str]:
    text = (repository / "README.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def shown(command: list[str], folder: Path, repository: Path) -> str:
    environment = {"PYTHONPATH": str(repository), "OPENBLAS_NUM_THREADS": "1", "PYTHONIOENCODING": "utf-8"}
    environment |= {"PATH": f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin", "HOME": str(folder)}
    result = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_the_library(repository: Path, tmp_path: Path) -> None:
    first, code = blocks(repository, "python")
    found = dict(line.split(" = ") for line in shown([sys.executable, "-c", first], tmp_path, repository).splitlines())
    for name, true in (("a1[0]", -0.8), ("a1[1]", -5e-5), ("b0[0]", 0.5), ("b0[1]", 0.0)):
        value, half_width = map(float, found[name].split(" ± "))
        assert abs(value - true) < 2 * half_width
    lines = shown([sys.executable, "-c", code], tmp_path, repository).splitlines()
    assert lines[0] == "energy 3510.4, no design needs less than 3510.3"
    assert [line.partition(":")[0] for line in lines[1:]] == ["p = 0.0", "p = 1.5", "p = 8.0"]


@pytest.mark.skipif(not (shutil.which("curl") and shutil.which("bash")), reason="needs bash and curl")
def test_the_service(repository: Path, tmp_path: Path, server: Server) -> None:
    code = "\n".join(blocks(repository, "sh")).replace("http://127.0.0.1:8000", server.url)
    assert server.url in code
    energy, effect = shown(["bash", "-euo", "pipefail", "-c", code], tmp_path, repository).split()
    assert float(energy) == pytest.approx(3510.4, rel=2e-2)
    assert effect == "quadratic_damping"
    lines = (tmp_path / "signal-0.csv").read_text().splitlines()
    assert lines[0] == "time,input"
    assert len(lines) == 1001
    assert "How the error fell" in (tmp_path / "report.html").read_text()
