"""Migrations are one line, each in a file of its number."""

import ast
from pathlib import Path

from app.store.migrate import MIGRATIONS


def stated(path: Path) -> dict[str, str | None]:
    """What a migration says of itself, read and not run."""
    assignments = [node for node in ast.parse(path.read_text()).body if isinstance(node, ast.Assign)]
    return {node.targets[0].id: ast.literal_eval(node.value) for node in assignments}  # type: ignore[attr-defined]


def test_every_migration_follows_the_one_before_it() -> None:
    paths = sorted((MIGRATIONS / "versions").glob("v*.py"))
    before = None
    for number, path in enumerate(paths, start=1):
        found = stated(path)
        assert path.name.startswith(f"v{number:04d}_"), f"{path.name} should be number {number:04d}"
        assert (found["revision"], found["down_revision"]) == (f"{number:04d}", before), path.name
        before = f"{number:04d}"
