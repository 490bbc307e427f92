"""The server starts light: what the jobs need is loaded by their child processes only."""

import os
import subprocess
import sys
from pathlib import Path

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
