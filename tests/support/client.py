"""The Python client of the service, generated from openapi/openapi.json the way a user would, and imported."""

import importlib
import io
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from tests.support.patience import PATIENCE, until
from tests.support.sources import ROOT

OPENAPI = ROOT / "openapi" / "openapi.json"
PACKAGE = "lpv_oed_client"
CONFIGURATION = f"package_name_override: {PACKAGE}\nproject_name_override: {PACKAGE}\npost_hooks: []\n"


class GenerationError(Exception):
    """The generator failed, or left something of the document out."""


def generate(document: Path, folder: Path) -> Path:
    """The generated package below `folder`; GenerationError when the generator warns that it left something out."""
    configuration = folder / "client.yml"
    configuration.write_text(CONFIGURATION)
    package = folder / PACKAGE
    command = [sys.executable, "-m", "openapi_python_client", "generate", "--meta", "none", "--fail-on-warning"]
    command += ["--path", str(document), "--output-path", str(package), "--config", str(configuration)]
    result = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if result.returncode:
        raise GenerationError(f"{result.stdout}\n{result.stderr}")
    return package


def load(package: Path) -> ModuleType:
    """Import a generated package, which lies outside of the import path."""
    sys.path.insert(0, str(package.parent))
    try:
        return importlib.import_module(package.name)
    finally:
        sys.path.remove(str(package.parent))


def operation(package: ModuleType, tag: str, name: str) -> ModuleType:
    """The module of one operation, with `sync_detailed` and the other ways to call it; names in snake case."""
    return importlib.import_module(f"{package.__name__}.api.{tag}.{name}")


def documents(package: ModuleType) -> ModuleType:
    """The module of all request and answer documents."""
    return importlib.import_module(f"{package.__name__}.models")


def file(package: ModuleType, content: bytes, name: str) -> object:
    """A file to be uploaded."""
    return importlib.import_module(f"{package.__name__}.types").File(payload=io.BytesIO(content), file_name=name)


class Caller:
    """Operations of the generated package by their tags and names; `m` holds the documents."""

    def __init__(self, package: ModuleType, url: str) -> None:
        self.package = package
        self.m = documents(package)
        self.client = package.Client(base_url=url, timeout=PATIENCE)

    def __call__(self, tag: str, name: str, *arguments: object, **options: object) -> Any:
        """The document that an operation answers with; whatever is no success is an error of the test."""
        answer = operation(self.package, tag, name).sync_detailed(*arguments, client=self.client, **options)
        assert 200 <= answer.status_code < 300, answer.parsed
        return answer.parsed

    def finished(self, job: Any) -> str:
        """Identifier of what a job made."""
        done = until(lambda: self._final(job.id), f"the end of {job}")
        assert done.state is self.m.JobState.SUCCEEDED, done.problem
        return str(done.result.id)

    def _final(self, job_id: str) -> Any:
        job = self("jobs", "get_job", job_id)
        return None if job.state in (self.m.JobState.QUEUED, self.m.JobState.RUNNING) else job
