"""The repository of resources: what was added is found, listed in pages, and never mixed up with other kinds."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.errors import NotFoundError, UnprocessableError
from app.store.database import Database
from app.store.identifiers import new_identifier
from app.store.resources import ResourceRepository

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=10,
)


@pytest.fixture
def resources(tmp_path: Path) -> ResourceRepository:
    database = Database(f"sqlite:///{tmp_path / 'test.sqlite'}")
    database.migrate()
    return ResourceRepository(database)


@given(document=st.dictionaries(st.text(max_size=5), JSON, max_size=4))
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_documents_come_back_as_they_were(resources: ResourceRepository, document: dict[str, object]) -> None:
    added = resources.add("plants", document)
    assert resources.get("plants", added.id) == added
    assert added.document == document
    assert added.href == f"/v1/plants/{added.id}"


def test_a_resource_is_found_under_its_kind_only(resources: ResourceRepository) -> None:
    added = resources.add("plants", {})
    assert resources.find("models", added.id) is None
    for identifier in (added.id[:-1], "x", "", "\x00", new_identifier()):
        with pytest.raises(NotFoundError):
            resources.get("plants", identifier)


@pytest.mark.parametrize("limit", [1, 2, 3, 7, 8])
def test_pages_together_are_the_list_newest_first(resources: ResourceRepository, limit: int) -> None:
    plant = new_identifier()
    wanted = [resources.add("models", {}, plant_id=plant).id for _ in range(7)]
    resources.add("models", {}, plant_id=new_identifier())
    resources.add("designs", {}, plant_id=plant)
    found: list[str] = []
    cursor: str | None = None
    while True:
        page = resources.list("models", plant, limit, cursor)
        assert len(page.items) <= limit
        found += [resource.id for resource in page.items]
        cursor = page.next_cursor
        if cursor is None:
            break
    assert found == wanted[::-1]
    assert len(resources.list("models").items) == 8


def test_a_bad_cursor_is_refused(resources: ResourceRepository) -> None:
    with pytest.raises(UnprocessableError):
        resources.list("models", cursor="; drop table")
