"""The database: migrations give the tables of the code, writers take turns, readers never wait."""

from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from threading import Event

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine, select, text
from sqlalchemy.dialects import postgresql
from sqlalchemy.exc import IntegrityError
from sqlalchemy.schema import CreateIndex, CreateTable

from app.store.database import Database
from app.store.identifiers import is_identifier, new_identifier
from app.store.lock import DirectoryLock
from app.store.rows import Base, ResourceRow
from tests.support.patience import PATIENCE


@pytest.fixture
def database(tmp_path: Path) -> Database:
    made = Database(f"sqlite:///{tmp_path / 'with space%.sqlite'}")
    made.migrate()
    return made


def row(document: dict[str, object] | None = None, **given: object) -> ResourceRow:
    moment = datetime(2026, 1, 2, 3, 4, 5, 678901, tzinfo=timezone(timedelta(hours=9)))
    fields: dict[str, object] = {"id": new_identifier(), "kind": "plants", "created_at": moment}
    return ResourceRow(**fields | {"document": document or {}} | given)


def test_migrations_give_the_tables_of_the_code(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    database = Database(f"sqlite:///{path}")
    database.migrate()
    database.migrate()
    with create_engine(f"sqlite:///{path}").connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []


def test_the_tables_are_also_tables_of_postgresql() -> None:
    dialect = postgresql.dialect()
    for table in Base.metadata.sorted_tables:
        statement = str(CreateTable(table).compile(dialect=dialect))
        assert "AUTOINCREMENT" not in statement
        for index in table.indexes:
            assert str(CreateIndex(index).compile(dialect=dialect))
    assert "BIGSERIAL" in str(CreateTable(Base.metadata.tables["job_events"]).compile(dialect=dialect))


def test_what_is_committed_is_synced(database: Database) -> None:
    with database.read() as session:
        pragmas = {name: session.scalar(text(f"PRAGMA {name}")) for name in ("journal_mode", "synchronous")}
        assert pragmas == {"journal_mode": "wal", "synchronous": 2}
        assert session.scalar(text("PRAGMA foreign_keys")) == 1


def test_a_failed_write_leaves_nothing(database: Database) -> None:
    identifier = new_identifier()

    def fail_on_the_way() -> None:
        with database.write() as session:
            session.add(row(id=identifier))
            session.flush()
            raise RuntimeError("on the way")

    with pytest.raises(RuntimeError, match="on the way"):
        fail_on_the_way()
    with database.read() as session:
        assert session.get(ResourceRow, identifier) is None


def test_one_job_can_make_one_resource_only(database: Database) -> None:
    with pytest.raises(IntegrityError), database.write() as session:
        session.add(row(job_id=new_identifier()))


def test_readers_do_not_wait_for_a_writer_and_see_what_is_committed(database: Database) -> None:
    written, go_on = Event(), Event()

    def write() -> None:
        with database.write() as session:
            session.add(row())
            session.flush()
            written.set()
            assert go_on.wait(PATIENCE)

    with ThreadPoolExecutor(1) as pool:
        writer = pool.submit(write)
        assert written.wait(PATIENCE)
        with database.read() as session:
            assert session.scalars(select(ResourceRow)).all() == []
        go_on.set()
        writer.result()
    with database.read() as session:
        assert len(session.scalars(select(ResourceRow)).all()) == 1


def test_writers_take_turns_also_across_connections(database: Database, tmp_path: Path) -> None:
    identifier = new_identifier()
    with database.write() as session:
        session.add(row({"count": 0}, id=identifier))
    other = Database(f"sqlite:///{tmp_path / 'with space%.sqlite'}")

    def increment(through: Database) -> None:
        with through.write() as session:
            found = session.get_one(ResourceRow, identifier)
            found.document = {"count": found.document["count"] + 1}

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(increment, [database, other] * 30))
    with database.read() as session:
        assert session.get_one(ResourceRow, identifier).document == {"count": 60}


def test_moments_come_back_in_utc(database: Database) -> None:
    given = row()
    moment = given.created_at
    with database.write() as session:
        session.add(given)
    with database.read() as session:
        found = session.get_one(ResourceRow, given.id).created_at
    assert found == moment
    assert found.tzinfo is UTC


def test_identifiers_are_unique_and_in_order_of_age() -> None:
    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(lambda _: new_identifier(), range(2000)))
    assert len(set(made)) == 2000
    one_after_the_other = [new_identifier() for _ in range(10_000)]
    assert one_after_the_other == sorted(one_after_the_other)
    assert all(is_identifier(identifier) and identifier[12] == "7" for identifier in made)
    assert not is_identifier(made[0] + "\n")


def test_one_server_per_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.store.lock.SECONDS_TO_WAIT", 0.1)
    first, second = DirectoryLock(tmp_path), DirectoryLock(tmp_path)
    first.acquire()
    with pytest.raises(RuntimeError, match="another server uses"):
        second.acquire()
    first.release()
    second.acquire()
    second.release()
