"""What led to a model: its versions, and everything that was done with them."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from app.schemas.models import Model
from app.services.comparisons import comparison_of
from app.services.diagnoses import diagnosis_of
from app.services.experiments import experiment_of
from app.services.models import model_of
from app.store.resources import Resource, ResourceRepository

PAGE = 100


@dataclass(frozen=True)
class History:
    """Rows of versions (oldest first), experiments, designs, the latest comparison and diagnosis of each version, and
    the latest signals of each design.

    The diagnosis of a version that was extended is the one that pointed to the effect, where it is known.
    """

    versions: tuple[Resource, ...]
    experiments: tuple[Resource, ...]
    designs: tuple[Resource, ...]
    comparisons: tuple[Resource, ...]
    diagnoses: tuple[Resource, ...]
    signals: tuple[Resource, ...]


def history(resources: ResourceRepository, model: Resource) -> History:
    """All that led to the model of a row."""
    rows = _versions(resources, model)
    versions = [model_of(row) for row in rows]
    comparisons = _latest(_rows_of_plant(resources, "comparisons", model.plant_id), rows, {})
    pointing = {
        after.parent_id: after.extension.diagnosis_id
        for after in versions
        if after.extension is not None and after.parent_id is not None
    }
    diagnoses = _latest(_rows_of_plant(resources, "diagnoses", model.plant_id), rows, pointing)
    names = [name for one in versions for name in _experiments(one)]
    names += [one.experiment_id for row in comparisons for one in comparison_of(row).experiments]
    names += [name for row in diagnoses for name in diagnosis_of(row).experiment_ids]
    experiments = _found(resources, "experiments", names)
    designs = [one.design_id for one in versions] + [experiment_of(row).design_id for row in experiments]
    designed = _found(resources, "designs", designs)
    played = _rows_of_plant(resources, "signals", model.plant_id) if designed else ()
    signals = _latest(played, designed, {}, "designId")
    return History(rows, experiments, designed, comparisons, diagnoses, signals)


def _versions(resources: ResourceRepository, latest: Resource) -> tuple[Resource, ...]:
    rows, parent = [latest], model_of(latest).parent_id
    while parent is not None and all(row.id != parent for row in rows):
        row = resources.find("models", parent)
        if row is None:
            break
        rows.append(row)
        parent = model_of(row).parent_id
    return tuple(reversed(rows))


def _experiments(model: Model) -> list[str]:
    held_out = [] if model.extension is None else model.extension.held_out_experiment_ids
    return [*model.experiment_ids, *held_out]


def _rows_of_plant(resources: ResourceRepository, kind: str, plant_id: str | None) -> Iterator[Resource]:
    cursor = None
    while True:
        page = resources.list(kind, plant_id, PAGE, cursor)
        yield from page.items
        cursor = page.next_cursor
        if cursor is None:
            return


def _latest(
    newest_first: Iterable[Resource],
    subjects: Sequence[Resource],
    preferred: dict[str, str | None],
    of: str = "modelId",
) -> tuple[Resource, ...]:
    """One row a subject that has any, in the order of the subjects; `of` is the field that names the subject."""
    chosen: dict[str, Resource] = {}
    for row in newest_first:
        name = row.document[of]
        if name not in chosen or preferred.get(name) == row.id:
            chosen[name] = row
    return tuple(chosen[one.id] for one in subjects if one.id in chosen)


def _found(resources: ResourceRepository, kind: str, names: Iterable[Any]) -> tuple[Resource, ...]:
    known = (resources.find(kind, name) for name in dict.fromkeys(names) if name is not None)
    return tuple(row for row in known if row is not None)
