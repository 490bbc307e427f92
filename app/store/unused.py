"""Removes array files that nothing names any more, such as raw uploads of failed jobs."""

import contextlib
import re
import time
from collections.abc import Iterator
from pathlib import Path

from sqlalchemy import Text, cast, select

from app.jobs.records import FINAL_STATES
from app.store.arrays import alone
from app.store.database import Database
from app.store.rows import JobRow, ResourceRow

DIGEST = re.compile(r"[0-9a-f]{64}")


def remove_unused(database: Database, root: Path, older_than_seconds: float) -> int:
    """Remove files older than that which no resource and no unfinished job names; returns how many bytes went.

    A file that is written again, or found to be there already, is young again, so what is about to be named stays.
    Does nothing while a backup is being made.
    """
    end = time.time() - older_than_seconds
    old = {path.stem: path for path in root.glob("??/*.npz") if _modified(path) < end}
    if not old:
        return 0
    for digest in _named(database):
        old.pop(digest, None)
    removed = 0
    with alone(root) as may:
        for path in old.values() if may else ():
            with contextlib.suppress(FileNotFoundError):
                if _modified(path) < end:
                    removed += path.stat().st_size
                    path.unlink()
    return removed


def _modified(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return float("inf")


def _named(database: Database) -> Iterator[str]:
    """Whatever looks like a hash in a resource or in what an unfinished job was given."""
    resources = select(ResourceRow.arrays, cast(ResourceRow.document, Text))
    payloads = select(cast(JobRow.payload, Text)).where(JobRow.state.not_in(FINAL_STATES))
    with database.read() as session:
        for row in (*session.execute(payloads), *session.execute(resources).yield_per(200)):
            for text in row:
                yield from DIGEST.findall(text or "")
