"""The server starts light: what the jobs need is loaded by their child processes only."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from app import __version__

HEAVY = ("scipy.signal", "scipy.stats", "scipy.optimize", "cvxpy", "clarabel", "plotly", "rich", "typer")
SCRIPT = f"""
import sys
from app.main import create_app
create_app().openapi()
print(*[name for name in {HEAVY!r} if name in sys.modules])
"""


def test_the_server_loads_nothing_heavy_and_writes_nothing(tmp_path: Path, repository: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(repository)}
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"HOST": "0.0.0.0"}, "set LPV_OED_TOKEN, or LPV_OED_HOST=127.0.0.1"),
        (
            {"PORT": "99999", "TOKEN": "a-token-of-the-team"},
            "LPV_OED_PORT: Input should be less than or equal to 65535",
        ),
        ({"TASK_PACKAGES": "one"}, "task_packages"),
    ],
)
def test_settings_that_are_refused_are_explained_without_a_traceback(
    tmp_path: Path, repository: Path, settings: dict[str, str], expected: str
) -> None:
    given = {f"LPV_OED_{name}": value for name, value in settings.items()}
    done = subprocess.run(
        [sys.executable, "-m", "app.cli", "serve"],
        env={**os.environ, "PYTHONPATH": str(repository), **given},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert done.stderr.strip().count("\n") == 0
    assert expected in done.stderr
    assert "a-token-of-the-team" not in done.stderr


def command(tmp_path: Path, repository: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    environment = {**os.environ, "PYTHONPATH": str(repository)}
    run = [sys.executable, "-m", "app.cli", *arguments]
    return subprocess.run(run, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)


def test_a_taken_port_is_said_plainly(tmp_path: Path, repository: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        done = command(tmp_path, repository, "serve", "--port", port, "--data-dir", "kept")
    assert done.returncode == 1
    assert f"another program listens on port {port} of 127.0.0.1" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "kept").exists()


def test_options_go_before_the_environment_and_are_checked(tmp_path: Path, repository: Path) -> None:
    assert "set LPV_OED_TOKEN" in command(tmp_path, repository, "serve", "--host", "0.0.0.0").stderr
    assert command(tmp_path, repository, "--version").stdout == f"lpv-oed {__version__}\n"
