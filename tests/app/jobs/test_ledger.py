"""The ledger without child processes: whatever happens in whatever order, nothing is lost and nothing is made twice."""

import shutil
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, consumes, invariant, multiple, rule
from sqlalchemy.exc import StatementError

from app.errors import ConflictError, NotFoundError, UnprocessableError
from app.jobs.hub import Hub
from app.jobs.journal import PATIENT_ATTEMPTS, Journal, Run
from app.jobs.ledger import Ledger
from app.jobs.outcomes import Made
from app.jobs.records import FINAL_STATES, JobRecord
from app.store.database import Database
from app.store.identifiers import new_identifier
from app.store.resources import ResourceRepository

MOST_ATTEMPTS = 3
ALLOWED = {
    None: {"queued"},
    "queued": {"started", "cancelled"},
    "requeued": {"started", "cancelled"},
    "started": {"progress", "succeeded", "failed", "cancelled", "requeued"},
    "progress": {"progress", "succeeded", "failed", "cancelled", "requeued"},
}


class NobodyRuns:
    """A dispatcher that only counts."""

    def __init__(self) -> None:
        self.calls: Counter[str] = Counter()

    def wake(self) -> None:
        self.calls["wake"] += 1

    def cancel(self, job_id: str) -> None:
        self.calls[job_id] += 1


class Books:
    """A ledger and a journal on a database of their own."""

    def __init__(self, directory: Path) -> None:
        self.url = f"sqlite:///{directory / 'test.sqlite'}"
        self.dispatcher = NobodyRuns()
        self.open()

    def open(self) -> None:
        self.database = Database(self.url)
        self.database.migrate()
        self.journal = Journal(self.database, Hub())
        self.ledger = Ledger(self.database, {"trial"}, self.dispatcher, Hub())
        self.resources = ResourceRepository(self.database)

    def submit(self, key: str | None = None, fingerprint: str | None = None) -> JobRecord:
        return self.ledger.submit("trial", {"key": key}, "trials", None, key, fingerprint)

    def claim(self) -> Run:
        job = self.journal.claim()
        assert job is not None
        return job.id, job.attempt


@pytest.fixture
def books(tmp_path: Path) -> Books:
    return Books(tmp_path)


def test_the_same_key_and_request_is_the_same_job(books: Books) -> None:
    first, second = books.submit("k", "a"), books.submit("k", "a")
    assert first == second
    assert [job.id for job in books.ledger.list().items] == [first.id]
    run = books.claim()
    books.journal.succeed(run, {}, None)
    assert books.submit("k", "a").state == "succeeded"


def test_the_same_key_and_another_request_is_a_conflict(books: Books) -> None:
    job = books.submit("k", "a")
    with pytest.raises(ConflictError, match=job.id):
        books.submit("k", "b")
    assert len(books.ledger.list().items) == 1


def test_without_a_key_every_request_is_a_job(books: Books) -> None:
    assert books.submit().id != books.submit().id


def test_the_same_key_from_many_threads_is_one_job(books: Books) -> None:
    with ThreadPoolExecutor(8) as pool:
        jobs = list(pool.map(lambda _: books.submit("k", "a").id, range(24)))
    assert len(set(jobs)) == 1


def test_every_job_is_claimed_once_by_many_threads(books: Books) -> None:
    jobs = [books.submit().id for _ in range(20)]
    with ThreadPoolExecutor(8) as pool:
        claimed = [job.id for job in pool.map(lambda _: books.journal.claim(), range(24)) if job]
    assert sorted(claimed) == jobs


def test_jobs_start_in_the_order_of_submission(books: Books) -> None:
    jobs = [books.submit().id for _ in range(5)]
    assert [books.claim()[0] for _ in range(5)] == jobs


def test_a_job_that_may_bring_the_server_down_waits_for_the_others(books: Books) -> None:
    suspect = books.submit().id
    for _ in range(PATIENT_ATTEMPTS + 1):
        assert books.claim()[0] == suspect
        books.journal.recover(1000)
    later = books.submit().id
    assert [books.claim()[0] for _ in range(2)] == [later, suspect]


def test_a_run_that_is_over_can_report_nothing(books: Books) -> None:
    books.submit()
    stale = books.claim()
    books.journal.recover(MOST_ATTEMPTS)
    present = books.claim()
    assert present == (stale[0], 2)
    books.journal.progress({stale: (0.9, "stale")})
    assert not books.journal.succeed(stale, {"run": "stale"}, None)
    assert not books.journal.fail(stale, {})
    assert books.ledger.get(stale[0]).fraction == 0
    assert books.journal.succeed(present, {"run": "present"}, None)
    assert not books.journal.succeed(present, {"run": "again"}, None)
    assert [r.document for r in books.resources.list("trials").items] == [{"run": "present"}]


def test_what_a_run_makes_beside_is_kept_with_the_rest_or_not_at_all(books: Books) -> None:
    books.submit()
    first, second = (Made("versions", new_identifier(), None, {"number": number}) for number in (1, 2))
    stale = books.claim()
    books.journal.recover(MOST_ATTEMPTS)
    present = books.claim()
    assert not books.journal.succeed(stale, {}, None, [first])
    with pytest.raises(StatementError, match="not JSON compliant"):
        books.journal.succeed(present, {"value": float("nan")}, None, [first])
    assert not books.resources.list("versions").items
    assert books.journal.succeed(present, {}, None, [first, second])
    assert [r.document["number"] for r in books.resources.list("versions").items] == [2, 1]


def test_a_resource_that_cannot_be_kept_leaves_the_job_running(books: Books) -> None:
    job = books.submit()
    run = books.claim()
    with pytest.raises(StatementError, match="not JSON compliant"):
        books.journal.succeed(run, {"value": float("nan")}, None)
    assert books.ledger.get(job.id).state == "running"
    assert books.resources.find("trials", job.resource_id) is None


def test_a_job_that_is_interrupted_again_and_again_fails_in_the_end(books: Books) -> None:
    job = books.submit()
    for attempt in range(1, MOST_ATTEMPTS + 1):
        assert books.claim() == (job.id, attempt)
        assert books.journal.recover(MOST_ATTEMPTS) == 1
    record = books.ledger.get(job.id)
    assert record.state == "failed"
    assert record.problem is not None
    assert record.problem["type"].endswith("job-interrupted")
    assert f"{MOST_ATTEMPTS} times" in record.problem["detail"]


def test_unknown_jobs_and_cursors_are_refused(books: Books) -> None:
    for identifier in ("", "x", "0" * 32, "\x00", "𝟘" * 32, "A" * 32):
        with pytest.raises(NotFoundError):
            books.ledger.get(identifier)
        with pytest.raises(NotFoundError):
            books.ledger.cancel(identifier)
    with pytest.raises(UnprocessableError) as refusal:
        books.ledger.list(cursor="x")
    assert refusal.value.errors[0].location == "query"
    with pytest.raises(ValueError, match="unknown kind of job 'other'; there are trial"):
        books.ledger.submit("other", {}, "trials")


def test_cancelling_tells_the_dispatcher(books: Books) -> None:
    job = books.submit()
    books.ledger.cancel(job.id)
    assert books.dispatcher.calls == {"wake": 1, job.id: 1}


class LedgerMachine(RuleBasedStateMachine):
    """Submits, runs, cancels and crashes in any order, beside a model of what must be there."""

    runs: Bundle[Run] = Bundle("runs")

    def __init__(self) -> None:
        super().__init__()
        self.directory = Path(tempfile.mkdtemp())
        self.books = Books(self.directory)
        self.acknowledged: list[str] = []
        self.states: dict[str, str] = {}
        self.attempts: Counter[str] = Counter()
        self.made: dict[str, int] = {}

    def teardown(self) -> None:
        self.books.database.close()
        shutil.rmtree(self.directory)

    @rule(key=st.none() | st.sampled_from("abc"), fingerprint=st.sampled_from("xy"))
    def submit(self, key: str | None, fingerprint: str) -> None:
        try:
            job = self.books.submit(key, fingerprint)
        except ConflictError:
            assert key is not None
            return
        if job.id not in self.states:
            self.acknowledged.append(job.id)
            self.states[job.id] = "queued"
        assert job.state == self.states[job.id]

    @rule(target=runs)
    def claim(self) -> Any:
        queued = [job for job in self.acknowledged if self.states[job] == "queued"]
        job = self.books.journal.claim()
        if job is None:
            assert not queued
            return multiple()
        assert job.id == queued[0]
        self.states[job.id] = "running"
        self.attempts[job.id] += 1
        assert job.attempt == self.attempts[job.id]
        return job.id, job.attempt

    @rule(run=runs, fraction=st.floats(0, 1))
    def progress(self, run: Run, fraction: float) -> None:
        self.books.journal.progress({run: (fraction, "on the way")})

    @rule(run=consumes(runs), number=st.integers())
    def succeed(self, run: Run, number: int) -> None:
        assert self.books.journal.succeed(run, {"number": number}, None) == self._finish(run, "succeeded")
        if self.states[run[0]] == "succeeded":
            self.made.setdefault(run[0], number)

    @rule(run=consumes(runs))
    def fail(self, run: Run) -> None:
        assert self.books.journal.fail(run, {"status": 500}) == self._finish(run, "failed")

    @rule(data=st.data())
    def cancel(self, data: st.DataObject) -> None:
        if not self.acknowledged:
            return
        job = data.draw(st.sampled_from(self.acknowledged))
        if self.states[job] in FINAL_STATES:
            with pytest.raises(ConflictError):
                self.books.ledger.cancel(job)
        else:
            assert self.books.ledger.cancel(job).state == "cancelled"
            self.states[job] = "cancelled"

    @rule()
    def crash(self) -> None:
        self.books.database.close()
        self.books.open()
        self.books.journal.recover(MOST_ATTEMPTS)
        for job, state in self.states.items():
            if state == "running":
                self.states[job] = "failed" if self.attempts[job] >= MOST_ATTEMPTS else "queued"

    @invariant()
    def nothing_is_lost_and_nothing_made_twice(self) -> None:
        jobs = {job.id: job for job in self.books.ledger.list(limit=500).items}
        assert {identifier: job.state for identifier, job in jobs.items()} == self.states
        made = {r.job_id: r.document["number"] for r in self.books.resources.list("trials", limit=500).items}
        assert made == self.made
        for job in jobs.values():
            last: str | None = None
            for event in self.books.ledger.events(job.id):
                assert event.name in ALLOWED[last]
                last = event.name

    def _finish(self, run: Run, state: str) -> bool:
        job, attempt = run
        present = self.states[job] == "running" and self.attempts[job] == attempt
        if present:
            self.states[job] = state
        return present


TestLedgerMachine = LedgerMachine.TestCase
TestLedgerMachine.settings = settings(
    max_examples=25, stateful_step_count=25, deadline=None, suppress_health_check=list(HealthCheck)
)
