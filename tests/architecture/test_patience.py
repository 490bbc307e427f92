"""No test depends on how busy the machine is: all wait as long as `tests.support.patience` says."""

import ast
from collections.abc import Iterator
from pathlib import Path

WAITS = ("wait_for_timeout", "perf_counter", "process_time")


def own_deadlines(text: str) -> Iterator[tuple[int, str]]:
    """Where a test gives up after seconds of its own, or times what it tests."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.keyword) and node.arg == "timeout" and isinstance(node.value, ast.Constant):
            yield node.value.lineno, "timeout"
        if isinstance(node, ast.Attribute) and node.attr in WAITS:
            yield node.lineno, node.attr


def test_no_test_has_a_deadline_of_its_own(repository: Path) -> None:
    found = {
        f"{path.relative_to(repository)}:{line} {what}"
        for path in (repository / "tests").rglob("*.py")
        for line, what in own_deadlines(path.read_text(encoding="utf-8"))
    }
    assert found == set()


def test_deadlines_are_seen() -> None:
    text = "run(timeout=3)\nrun(timeout=PATIENCE)\npage.wait_for_timeout(100)\nbegan = time.perf_counter()"
    assert sorted(own_deadlines(text)) == [(1, "timeout"), (3, "wait_for_timeout"), (4, "perf_counter")]
