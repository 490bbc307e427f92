"""The ledger on PostgreSQL: several servers take jobs from it, none twice, and what a dead one ran goes on."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import create_engine
from sqlalchemy.exc import DBAPIError

from app.container import Container
from app.jobs.hub import Hub
from app.jobs.journal import Journal
from app.jobs.ledger import Ledger
from app.settings import Settings
from app.store.database import Database
from app.store.identifiers import new_identifier
from app.store.postgres import driver_url
from app.store.resources import ResourceRepository
from app.store.rows import Base
from tests.app.conftest import TASK_PACKAGES
from tests.app.jobs.test_ledger import MOST_ATTEMPTS, NobodyRuns
from tests.support.patience import until
from tests.support.postgres import Postgres


@pytest.fixture
def database(postgres: Postgres) -> Iterator[Database]:
    made = Database(postgres.database())
    made.migrate()
    yield made
    made.close()


def ledger_on(database: Database) -> Ledger:
    return Ledger(database, {"trial"}, NobodyRuns(), Hub())


def test_migrations_give_the_tables_of_the_code_also_from_many_servers_at_once(postgres: Postgres) -> None:
    url = postgres.database()
    databases = [Database(url) for _ in range(4)]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(Database.migrate, databases))
    with create_engine(driver_url(url)).connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []


def test_every_job_is_claimed_once_by_many_servers(database: Database) -> None:
    ledger = ledger_on(database)
    jobs = [ledger.submit("trial", {}, "trials").id for _ in range(30)]
    servers = [Journal(database, Hub(), new_identifier()) for _ in range(4)]
    with ThreadPoolExecutor(8) as pool:
        claimed = [job.id for job in pool.map(lambda number: servers[number % 4].claim(), range(40)) if job]
    assert sorted(claimed) == jobs


def test_the_same_key_from_many_servers_is_one_job(database: Database) -> None:
    ledgers = [ledger_on(database) for _ in range(4)]
    with ThreadPoolExecutor(8) as pool:
        submitted = pool.map(lambda n: ledgers[n % 4].submit("trial", {}, "trials", None, "key", "a").id, range(24))
    assert len(set(submitted)) == 1


def test_only_what_dead_servers_ran_is_queued_again(database: Database) -> None:
    ledger = ledger_on(database)
    jobs = [ledger.submit("trial", {}, "trials").id for _ in range(2)]
    living, dead = (Journal(database, Hub(), name) for name in ("living", "dead"))
    assert [living.claim(), dead.claim()] != [None, None]
    assert living.recover(MOST_ATTEMPTS, ["living"]) == 1
    assert [ledger.get(job).state for job in jobs] == ["running", "queued"]
    again = living.claim()
    assert again is not None
    assert (again.id, again.attempt) == (jobs[1], 2)
    assert not dead.succeed((jobs[1], 1), {"by": "dead"}, None)
    assert living.succeed((jobs[1], 2), {"by": "living"}, None)
    assert [made.document for made in ResourceRepository(database).list("trials").items] == [{"by": "living"}]


def container(tmp_path: Path, url: str, workers: int = 1) -> Container:
    settings = Settings(
        data_dir=tmp_path / "data", database_url=url, task_packages=TASK_PACKAGES, workers=workers, lease_seconds=2.0
    )
    made = Container(settings)
    made.start()
    return made


def state(of: Container, job_id: str) -> str:
    return of.ledger.get(job_id).state


def succeeded(of: Container, job_id: str) -> bool:
    """False too while the database does not answer."""
    try:
        return state(of, job_id) == "succeeded"
    except DBAPIError:
        return False


def test_a_cancellation_reaches_the_server_that_runs_the_job(postgres: Postgres, tmp_path: Path) -> None:
    url = postgres.database()
    first = container(tmp_path, url)
    note = tmp_path / "pid"
    job = first.ledger.submit("trial", {"note": str(note), "hold": str(tmp_path / "never")}, "trials").id
    until(note.exists, "the start of the job")
    second = container(tmp_path, url)
    try:
        second.ledger.cancel(job)
        until(lambda: not Path(f"/proc/{note.read_text()}").exists(), "the end of the process")
        assert state(first, job) == "cancelled"
        next_job = second.ledger.submit("trial", {}, "trials").id
        until(lambda: state(first, next_job) == "succeeded", "the next job")
    finally:
        first.stop()
        second.stop()


def test_servers_hear_of_each_others_jobs_and_wait_for_the_database(postgres: Postgres, tmp_path: Path) -> None:
    url = postgres.database()
    first, second = container(tmp_path, url, 2), container(tmp_path, url, 2)
    try:
        job = first.ledger.submit("trial", {"hold": str(tmp_path / "go")}, "trials").id
        until(lambda: state(second, job) == "running", "the start of the job")
        postgres.stop()
        (tmp_path / "go").touch()  # its outcome cannot be written down now
        postgres.start()
        until(lambda: succeeded(second, job), "the end of the job")
        assert len(first.resources.list("trials").items) == 1
        later = [second.ledger.submit("trial", {}, "trials").id for _ in range(6)]
        until(lambda: all(state(first, one) == "succeeded" for one in later), "all jobs")
    finally:
        first.stop()
        second.stop()
