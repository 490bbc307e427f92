"""What the service is made of, wired together once."""

from app.access.audit import Audit
from app.access.tokens import Tokens
from app.jobs.discovery import discover_kinds
from app.jobs.executor import LocalExecutor
from app.jobs.hub import Hub
from app.jobs.journal import Journal
from app.jobs.leases import Leases
from app.jobs.ledger import Ledger
from app.services.housekeeping import Housekeeping
from app.services.job_events import JobEvents
from app.services.readiness import Readiness
from app.settings import Settings
from app.store.arrays import ArrayStore
from app.store.bin import Bin
from app.store.database import Database
from app.store.identifiers import new_identifier, observe
from app.store.lock import locks_of
from app.store.postgres import Listener
from app.store.resources import ResourceRepository
from app.store.room import free_bytes
from app.telemetry.metrics import Gauge, Metrics


class Container:
    """What routers and services use: `settings`, `resources`, `bin`, `ledger`, `arrays`, `database`, `job_events`.

    Making one touches neither disk nor network; `start` does.
    """

    def __init__(self, settings: Settings) -> None:
        kinds = discover_kinds(settings.task_packages)
        url, server = settings.resolved_database_url, new_identifier()
        self.settings = settings
        self.database = Database(url)
        self.arrays = ArrayStore(settings.arrays_dir, settings.max_array_bytes, settings.disk_reserve_bytes)
        self.resources = ResourceRepository(self.database)
        self.bin = Bin(self.database)
        self.hub = Hub()
        self._journal = Journal(self.database, self.hub, server)
        self._executor = LocalExecutor(self._journal, kinds, settings)
        self.ledger = Ledger(self.database, kinds, self._executor, self.hub)
        self.job_events = JobEvents(self.ledger, self.hub, settings.max_event_streams)
        self.readiness = Readiness(self.database, settings.data_dir, settings.disk_reserve_bytes)
        self._leases = Leases(
            self.database, self._journal, self._executor, server, settings.lease_seconds, settings.job_attempts
        )
        self._listener = Listener(url, self._heard)
        self._housekeeping = Housekeeping(self.database, settings.arrays_dir, settings.unused_days)
        self._locks = locks_of(url, settings.data_dir)
        self.tokens = Tokens(self.database, settings.bearer_token)
        self.audit = Audit(self.database)
        self.metrics = Metrics(self._gauges())
        self._started = False

    def start(self) -> None:
        """Take the data directory, bring the tables up to date, go on with interrupted jobs; once only."""
        if self._started:
            return
        self.settings.data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
        try:
            for lock in self._locks:
                lock.acquire()
            self._prepare()
        except BaseException:
            self._release()
            raise
        self._executor.start()
        self._housekeeping.start()
        self._started = True

    def stop_work(self) -> None:
        """End the jobs, which are queued again, and the streams of events; requests are answered as before."""
        self._executor.stop()
        self.hub.close()

    def stop(self) -> None:
        """End the jobs and let go of everything."""
        self.stop_work()
        self._housekeeping.stop()
        if self.database.is_shared:
            self._listener.stop()
            self._leases.stop()
        self.database.close()
        self._release()

    def _prepare(self) -> None:
        self.arrays.prepare(self.database.is_shared)
        self.database.migrate()
        observe(self.database.newest_identifier() or "0")
        if self.database.is_shared:
            self._leases.start()
            self._listener.start()
        else:
            self._journal.recover(self.settings.job_attempts)

    def _gauges(self) -> dict[str, Gauge]:
        return {
            "lpv_oed_jobs": ("Jobs by their state", "state", self.ledger.count),
            "lpv_oed_event_streams": ("Open event streams", "", lambda: {"": self.job_events.streams}),
            "lpv_oed_free_bytes": ("Room on the disk", "", lambda: {"": free_bytes(self.settings.data_dir)}),
            "lpv_oed_ready": ("1 while work can be taken in", "", lambda: {"": not self.readiness.reasons()}),
        }

    def _heard(self, job_id: str, event: str) -> None:
        """Something happened to a job, maybe on another server."""
        observe(job_id)
        self.hub.notify(job_id)
        if event in ("queued", "requeued"):
            self._executor.wake()
        if event in ("cancelled", "requeued"):
            self._executor.end_lost(job_id)

    def _release(self) -> None:
        for lock in self._locks:
            lock.release()
