"""The commands backup and restore, as an operator gives them."""

import os
import subprocess
import sys
from pathlib import Path

from tests.support.server import running_server


def told(repository: Path, data: Path, *command: str, **more: str) -> "subprocess.CompletedProcess[str]":
    environment = {**os.environ, "PYTHONPATH": str(repository), "LPV_OED_DATA_DIR": str(data), **more}
    arguments = [sys.executable, "-m", "app.cli", *command]
    return subprocess.run(arguments, env=environment, capture_output=True, text=True, check=False)


def test_there_and_back(repository: Path, tmp_path: Path) -> None:
    with running_server(tmp_path / "data"):
        done = told(repository, tmp_path / "data", "backup", str(tmp_path / "copy"))
    assert (done.returncode, done.stderr) == (0, "")
    assert "0 resources, 0 jobs, 0 array files" in " ".join(done.stdout.split())
    done = told(repository, tmp_path / "elsewhere", "restore", str(tmp_path / "copy"))
    assert (done.returncode, done.stderr) == (0, "")
    with running_server(tmp_path / "elsewhere") as server:
        assert server.healthy()
        refused = told(repository, tmp_path / "elsewhere", "restore", str(tmp_path / "copy"))
    assert refused.returncode == 1
    assert "another server uses" in refused.stderr
    assert "Traceback" not in refused.stderr


def test_another_database_is_backed_up_by_its_own_tool(repository: Path, tmp_path: Path) -> None:
    given = {"LPV_OED_DATABASE_URL": "postgresql://nowhere/none"}
    done = told(repository, tmp_path, "backup", str(tmp_path / "copy"), **given)
    assert done.returncode == 1
    assert "pg_dump" in done.stderr
