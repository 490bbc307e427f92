"""A real server process for tests: started on a free loopback port, waited for, and always ended."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

from tests.support.patience import PATIENCE

ROOT = Path(__file__).resolve().parents[2]


def free_port() -> int:
    """A port of 127.0.0.1 that nobody listens on now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@dataclass(frozen=True)
class Server:
    """A running server process: `url` without a slash at the end, its data directory and its log."""

    url: str
    data_directory: Path
    process: "subprocess.Popen[bytes]"
    log: Path

    def log_text(self) -> str:
        return self.log.read_text(errors="replace")

    def healthy(self) -> bool:
        try:
            with urlopen(f"{self.url}/v1/health", timeout=PATIENCE) as answer:
                return bool(answer.status == 200)
        except (URLError, OSError):
            return False

    def wait_until_healthy(self, seconds: float = PATIENCE) -> float:
        """Seconds until /v1/health answers 200; RuntimeError with the log when the process ends or time runs out."""
        began = time.monotonic()
        while time.monotonic() - began < seconds:
            if self.process.poll() is not None:
                raise RuntimeError(f"the server ended with code {self.process.returncode}:\n{self.log_text()}")
            if self.healthy():
                return time.monotonic() - began
            time.sleep(0.05)
        raise RuntimeError(f"the server was not healthy within {seconds} s:\n{self.log_text()}")

    def kill(self) -> None:
        """End the process at once, as a power cut would (SIGKILL)."""
        self.process.kill()
        self.process.wait(timeout=PATIENCE)

    def stop(self) -> None:
        """Ask the process to end (SIGTERM); kill it when it does not."""
        if self.process.poll() is not None:
            return
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            self.kill()


def start_server(data_directory: Path, environment: dict[str, str] | None = None) -> Server:
    """Start a server on `data_directory` without waiting for it; `environment` overrides the settings it is given."""
    port = free_port()
    data_directory.mkdir(parents=True, exist_ok=True)
    log = data_directory.parent / f"{data_directory.name}-server-{port}.log"
    settings = {
        "LPV_OED_DATA_DIR": str(data_directory),
        "LPV_OED_HOST": "127.0.0.1",
        "LPV_OED_PORT": str(port),
        "PYTHONPATH": str(ROOT),
        **(environment or {}),
    }
    return Server(f"http://127.0.0.1:{port}", data_directory, start_process("app.serve", settings, log), log)


def start_process(module: str, settings: dict[str, str], log: Path) -> "subprocess.Popen[bytes]":
    """Start `python -m module` with these settings in their data directory, its output in `log`."""
    with log.open("wb") as output:
        return subprocess.Popen(
            [sys.executable, "-m", module],
            cwd=settings["LPV_OED_DATA_DIR"],
            env={**os.environ, **settings},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
        )


@contextmanager
def running_worker(data_directory: Path, environment: dict[str, str]) -> "Iterator[subprocess.Popen[bytes]]":
    """A worker without HTTP on the jobs of servers, killed at the end of the block where it still runs."""
    settings = {"LPV_OED_DATA_DIR": str(data_directory), "PYTHONPATH": str(ROOT), **environment}
    process = start_process("app.work", settings, data_directory.parent / f"worker-{free_port()}.log")
    try:
        yield process
    finally:
        process.kill()
        process.wait(timeout=PATIENCE)


@contextmanager
def running_server(data_directory: Path, environment: dict[str, str] | None = None) -> Iterator[Server]:
    """A healthy server on `data_directory` that is stopped at the end of the block."""
    server = start_server(data_directory, environment)
    try:
        server.wait_until_healthy()
        yield server
    finally:
        server.stop()
