"""Delete, restore, rename: what depends on a resource goes with it, and nothing else ever changes."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.errors import ConflictError, NotFoundError
from app.store.bin import Bin
from app.store.database import Database
from app.store.resources import Resource, ResourceRepository


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    made = Database(f"sqlite:///{tmp_path / 'store.sqlite'}")
    made.migrate()
    yield made
    made.close()


def everything(resources: ResourceRepository, made: list[Resource]) -> dict[str, dict[str, Any] | None]:
    found = {one.id: resources.find(one.kind, one.id) for one in made}
    return {name: None if one is None else one.document for name, one in found.items()}


def grown(resources: ResourceRepository, generator: np.random.Generator, count: int) -> list[Resource]:
    """Resources of one plant, each naming up to two earlier ones."""
    made = [resources.add("plants", {"name": "plant"})]
    for i in range(count):
        named = generator.choice(len(made), size=min(2, len(made)), replace=False)
        links = [made[int(k)].id for k in named if generator.random() < 0.6 and made[int(k)].kind != "plants"]
        document = {"name": f"thing {i}", "on": links, "deep": {"more": links[:1]}}
        made.append(resources.add("models" if i % 2 else "experiments", document, made[0].id))
    return made


def standing_on(made: list[Resource], root: Resource) -> set[str]:
    """By the definition: what names it, or names what does; of a plant all of it."""
    if root.kind == "plants":
        return {one.id for one in made if one.plant_id == root.id}
    found = {root.id}
    for one in made:  # later ones name earlier ones only
        if set(one.document.get("on", ())) & found:
            found.add(one.id)
    return found - {root.id}


@pytest.mark.parametrize("seed", range(6))
def test_deletion_takes_exactly_what_depends_and_restoring_brings_back_all(database: Database, seed: int) -> None:
    generator = np.random.default_rng(seed)
    resources, kept = ResourceRepository(database), Bin(database)
    made = grown(resources, generator, 14)
    other = resources.add("plants", {"name": "untouched"})
    before = everything(resources, [*made, other])
    deletions: list[str] = []
    for _ in range(5):
        present = [one for one in made if resources.find(one.kind, one.id) is not None]
        root = present[int(generator.integers(len(present)))] if len(present) > 1 else present[0]
        expected = standing_on(present, root)
        assert {one.id for one in kept.dependents(root.kind, root.id)} == expected
        if expected:
            with pytest.raises(ConflictError, match="withDependents"):
                kept.delete(root.kind, root.id, with_dependents=False)
        gone = kept.delete(root.kind, root.id, with_dependents=True)
        assert gone[0].id == root.id
        assert {one.id for one in gone[1:]} == expected
        deletions.append(root.id)
        left = everything(resources, [*made, other])
        present_ids = {one.id for one in present} - expected - {root.id}
        assert {name for name, document in left.items() if document is not None} == present_ids | {other.id}
        if root.kind == "plants":
            break
    for root_id in reversed(deletions):
        kept.restore(root_id)
    assert everything(resources, [*made, other]) == before
    assert kept.deleted(50, None).items == []


def test_what_stands_on_something_deleted_is_not_restored_before_it(database: Database) -> None:
    resources, kept = ResourceRepository(database), Bin(database)
    plant = resources.add("plants", {"name": "plant"})
    experiment = resources.add("experiments", {"name": "e"}, plant.id)
    model = resources.add("models", {"name": "m", "experimentIds": [experiment.id]}, plant.id)
    kept.delete("models", model.id, with_dependents=False)
    kept.delete("experiments", experiment.id, with_dependents=False)
    with pytest.raises(ConflictError, match=f"restore {experiment.id} first"):
        kept.restore(model.id)
    assert [(one.id, others) for one, _, others in kept.deleted(50, None).items] == [(model.id, 0), (experiment.id, 0)]
    kept.restore(experiment.id)
    kept.restore(model.id)
    assert resources.get("models", model.id).document == model.document
    for wrong in (model.id, "0" * 32, "none"):
        with pytest.raises(NotFoundError):
            kept.restore(wrong)


def test_deleted_things_are_found_nowhere(database: Database) -> None:
    resources, kept = ResourceRepository(database), Bin(database)
    plant = resources.add("plants", {"name": "plant"})
    experiment = resources.add("experiments", {"name": "e"}, plant.id)
    kept.delete("experiments", experiment.id, with_dependents=False)
    assert resources.find("experiments", experiment.id) is None
    assert resources.list("experiments").items == []
    with pytest.raises(NotFoundError):
        kept.delete("experiments", experiment.id, with_dependents=False)
    with pytest.raises(NotFoundError):
        kept.change("experiments", experiment.id, {})
