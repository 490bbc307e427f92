"""The commands backup and restore."""

from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from app.serve import settings_or_exit, why_not_started
from app.settings import Settings
from app.store import backup as store


def backup(target: Path) -> None:
    """Copy the data directory of the environment to `target`."""
    settings = _on_sqlite()
    copied = _explained(lambda: store.backup(settings.data_dir, target))
    Console().print(f"{target}: {_told(copied)}")


def restore(source: Path) -> None:
    """Make the data directory of the environment of a backup."""
    settings = _on_sqlite()
    copied = _explained(lambda: store.restore(source, settings.data_dir))
    Console().print(f"{settings.data_dir}: {_told(copied)}")


def _on_sqlite() -> Settings:
    settings = settings_or_exit()
    if settings.database_url is not None:
        raise SystemExit(
            "LPV_OED_DATABASE_URL is set: back that database up first with its own tool, such as pg_dump, and copy the"
            f" folder {settings.arrays_dir} after it; restore both"
        )
    return settings


def _explained(work: Callable[[], store.Copied]) -> store.Copied:
    try:
        return work()
    except store.BackupError as error:
        raise SystemExit(str(error)) from None
    except Exception as error:
        reason = why_not_started(error)
        if reason is None:
            raise
        raise SystemExit(reason) from None


def _told(copied: store.Copied) -> str:
    return f"{copied.rows.get('resources', 0)} resources, {copied.rows.get('jobs', 0)} jobs, {copied.files} array files"
