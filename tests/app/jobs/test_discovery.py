"""Kinds of jobs are found by their modules, and every one keeps to the rules."""

import sys
from pathlib import Path

import pytest

from app.jobs.discovery import discover_kinds, load_task

KINDS = discover_kinds(("app.jobs.tasks",))


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_every_task_keeps_to_the_rules(kind: str) -> None:
    task = load_task(KINDS[kind])
    assert kind == task.KIND
    assert task.__doc__


def test_the_four_kinds_of_the_service_are_there() -> None:
    assert {"experiment", "identification", "state_space_identification", "design", "signals"} <= KINDS.keys()


def test_the_same_kind_twice_is_refused() -> None:
    with pytest.raises(ValueError, match=r"'trial' is in tests\.app\.trial_tasks\.trial and in"):
        discover_kinds(("tests.app.trial_tasks", "tests.app.trial_tasks"))


def test_a_module_that_is_no_task_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "stray_task.py").write_text("KIND = 'other'\n\ndef run(payload, context): ...\n")
    with pytest.raises(TypeError, match="KIND = 'stray_task'"):
        load_task("stray_task")
    sys.modules.pop("stray_task")
