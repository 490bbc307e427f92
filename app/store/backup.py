"""Backups of a data directory that is in use, and what is made of them again.

The database is copied first, by SQLite's online backup, which is one moment of it; the array files after it. A row is
committed only after the files that it names are on the disk, and files never change, so every file that this moment
names is there to be copied. What the collector of unused files would remove meanwhile waits for the end of the backup.
"""

import hashlib
import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from app.store.arrays import keeping
from app.store.lock import DirectoryLock

DATABASE = "lpv-oed.sqlite"
ARRAYS = "arrays"
PAGES_AT_ONCE = 1000


class BackupError(RuntimeError):
    """A backup cannot be made or used; the message says what to change."""


@dataclass(frozen=True)
class Copied:
    """How much was copied: rows of the database by table, and array files."""

    rows: dict[str, int]
    files: int


def backup(data: Path, target: Path) -> Copied:
    """Copy a data directory that may be in use to `target`; files of an earlier backup there are used again.

    Until all of it is on the disk the database in `target` is that of the earlier backup, or there is none.
    """
    if not (data / DATABASE).is_file():
        raise BackupError(f"there is no {DATABASE} in {data}; set LPV_OED_DATA_DIR to the data directory")
    if target.resolve() == data.resolve() or data.resolve() in target.resolve().parents:
        raise BackupError(f"{target} is in the data directory itself; choose a place outside of it")
    target.mkdir(mode=0o700, parents=True, exist_ok=True)
    new = target / f"{DATABASE}.new"
    with keeping(data / ARRAYS):
        _copy_database(data / DATABASE, new)
        files = _copy_arrays(data / ARRAYS, target / ARRAYS)
    rows = _examined(new)
    new.replace(target / DATABASE)
    _sync(target)
    return Copied(rows, files)


def restore(source: Path, data: Path) -> Copied:
    """Make a data directory of a backup; refuses one that has data, and a backup that is not whole."""
    if not (source / DATABASE).is_file():
        raise BackupError(f"there is no {DATABASE} in {source}, so it is no backup, or one that was not finished")
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    lock = DirectoryLock(data)
    lock.acquire()
    try:
        if any((data / name).exists() for name in (DATABASE, f"{DATABASE}-wal", ARRAYS)):
            raise BackupError(f"{data} has data already; move it away, or set LPV_OED_DATA_DIR to an empty directory")
        new = data / f"{DATABASE}.new"
        _copy_database(source / DATABASE, new)
        rows = _examined(new)
        files = _copy_arrays(source / ARRAYS, data / ARRAYS)
        new.replace(data / DATABASE)
        _sync(data)
    finally:
        lock.release()
    return Copied(rows, files)


def _copy_database(source: Path, target: Path) -> None:
    target.unlink(missing_ok=True)
    with (
        closing(sqlite3.connect(f"file:{source}?mode=ro", uri=True, timeout=60)) as reader,
        closing(sqlite3.connect(target)) as writer,
    ):
        reader.execute("BEGIN")  # one moment: what is written meanwhile does not begin the copy anew
        reader.execute("SELECT count(*) FROM sqlite_master").fetchone()
        reader.backup(writer, pages=PAGES_AT_ONCE)
        writer.execute("PRAGMA journal_mode=DELETE")


def _examined(path: Path) -> dict[str, int]:
    with closing(sqlite3.connect(path)) as connection:
        found = connection.execute("PRAGMA integrity_check(1)").fetchone()[0]
        if found != "ok":
            raise BackupError(f"the copy {path} is damaged ({found}); the disk or the original is at fault")
        tables = [name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        return {name: connection.execute(f'SELECT count(*) FROM "{name}"').fetchone()[0] for name in sorted(tables)}


def _copy_arrays(source: Path, target: Path) -> int:
    target.mkdir(parents=True, exist_ok=True)
    count = 0
    for path in _array_files(source):
        copy = target / path.parent.name / path.name
        copy.parent.mkdir(exist_ok=True)
        if not (copy.is_file() and copy.stat().st_size == path.stat().st_size):
            _copy_file(path, copy)
        count += 1
    os.sync()  # all of them at once, and the folders, before the database appears that names them
    return count


def _array_files(root: Path) -> Iterator[Path]:
    return (path for path in sorted(root.glob("??/*.npz")))


def _copy_file(path: Path, copy: Path) -> None:
    new = copy.with_suffix(".new")
    with path.open("rb") as source, new.open("wb") as target:
        shutil.copyfileobj(source, target)
    with new.open("rb") as written:
        if hashlib.file_digest(written, "sha256").hexdigest() != path.stem:
            new.unlink()
            raise BackupError(f"the array file {path} is damaged; restore it from an earlier backup, or remove it")
    new.replace(copy)


def _sync(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
