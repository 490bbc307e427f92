"""Runs tasks in this process, with arrays in a folder that goes away."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

from app.jobs.discovery import load_task
from app.jobs.task import TaskContext, TaskResult
from app.store.arrays import ArrayStore

PLANT_ID = "plant"
MODEL_ID = "model"
DESIGN_ID = "design"
MAX_ARRAY_BYTES = 4 * 1024**3


@dataclass(frozen=True)
class Workplace:
    """Where tasks run without a server."""

    arrays: ArrayStore
    console: Console

    def run(self, kind: str, payload: dict[str, Any]) -> TaskResult:
        """Run the task of a kind, showing how far it is."""
        columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
        with Progress(*columns, console=self.console, transient=True) as progress:
            shown = progress.add_task(kind, total=1.0)

            def report(fraction: float, message: str) -> None:
                progress.update(shown, completed=fraction, description=f"{kind}: {message}")

            return load_task(f"app.jobs.tasks.{kind}").run(payload, TaskContext(self.arrays, report))


def stored(document: dict[str, Any], identifier: str, **more: Any) -> dict[str, Any]:
    """A document as if it had been kept under an identifier."""
    return {**document, "id": identifier, "createdAt": datetime.now(UTC), **more}


@contextmanager
def workplace(console: Console | None = None) -> Iterator[Workplace]:
    """A workplace that shows progress on a console, standard error unless given; its arrays are removed at the end."""
    with TemporaryDirectory(prefix="lpv-oed-") as folder:
        store = ArrayStore(Path(folder), MAX_ARRAY_BYTES)
        store.prepare()
        yield Workplace(store, console or Console(stderr=True))
