"""A PostgreSQL of its own for tests, on loopback, run by a user without rights; it can be killed and started again."""

import os
import pwd
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from tests.support.patience import PATIENCE, until
from tests.support.server import free_port

MISSING = "NO POSTGRESQL: install it (Debian: apt-get install postgresql), and the tests of several servers run"
FOLDERS = sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)


def program(name: str) -> Path | None:
    """A program of PostgreSQL, which Debian does not put on the path."""
    for folder in FOLDERS:
        if (folder / name).exists():
            return folder / name
    found = shutil.which(name)
    return None if found is None else Path(found)


@dataclass
class Postgres:
    """One cluster; `url` names a fresh database with every call of `database`."""

    directory: Path
    user: str | None
    port: int = field(default_factory=free_port)
    process: "subprocess.Popen[bytes] | None" = None
    databases: int = 0

    def start(self) -> None:
        """Start the server and wait until it answers."""
        server = program("postgres")
        assert server is not None
        options = ["-D", self.directory / "data", "-k", self.directory, "-p", str(self.port)]
        options += ["-c", "listen_addresses=127.0.0.1", "-c", "max_connections=200"]
        with (self.directory / "log").open("ab") as log:
            self.process = subprocess.Popen([server, *options], user=self.user, stdout=log, stderr=log, cwd="/")
        until(self._answers, "an answer of PostgreSQL", between=0.1)

    def stop(self, how: int = signal.SIGINT) -> None:
        """End the server: by default without waiting for its clients, with SIGKILL as a power cut would."""
        assert self.process is not None
        self.process.send_signal(how)
        self.process.wait(timeout=PATIENCE)

    def database(self) -> str:
        """The URL of a new, empty database."""
        self.databases += 1
        name = f"trial{self.databases}"
        self._run("createdb", "-h", "127.0.0.1", "-p", str(self.port), "-U", "lpv_oed", name)
        return f"postgresql://lpv_oed@127.0.0.1:{self.port}/{name}"

    def initialise(self) -> None:
        self._run(
            "initdb", "-D", str(self.directory / "data"), "-U", "lpv_oed", "-A", "trust", "-E", "UTF8", "--no-sync"
        )

    def _answers(self) -> bool:
        command = [str(program("pg_isready")), "-q", "-h", "127.0.0.1", "-p", str(self.port)]
        return subprocess.run(command, check=False).returncode == 0

    def _run(self, name: str, *arguments: str) -> None:
        command = [str(program(name)), *arguments]
        done = subprocess.run(command, user=self.user, capture_output=True, text=True, check=False, cwd="/")
        assert done.returncode == 0, done.stderr


@contextmanager
def running_postgres() -> Iterator[Postgres]:
    """A cluster that is gone at the end of the block."""
    directory = Path(tempfile.mkdtemp(prefix="lpv-oed-postgres-"))
    user = None if os.getuid() else _user_without_rights()
    if user is not None:
        shutil.chown(directory, user)
    cluster = Postgres(directory, user)
    try:
        cluster.initialise()
        cluster.start()
        yield cluster
    finally:
        if cluster.process is not None and cluster.process.poll() is None:
            cluster.stop()
        shutil.rmtree(directory, ignore_errors=True)


def _user_without_rights() -> str:
    """PostgreSQL refuses to run as root."""
    names = {entry.pw_name for entry in pwd.getpwall()}
    return next(name for name in ("postgres", "nobody") if name in names)
