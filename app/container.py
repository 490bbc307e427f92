"""What the service is made of, wired together once."""

from app.jobs.discovery import discover_kinds
from app.jobs.executor import LocalExecutor
from app.jobs.hub import Hub
from app.jobs.journal import Journal
from app.jobs.ledger import Ledger
from app.services.housekeeping import Housekeeping
from app.services.job_events import JobEvents
from app.services.readiness import Readiness
from app.settings import Settings
from app.store.arrays import ArrayStore
from app.store.database import Database
from app.store.identifiers import observe
from app.store.lock import DirectoryLock
from app.store.resources import ResourceRepository


class Container:
    """The parts that routers and services use: `settings`, `resources`, `ledger`, `arrays`, `hub`, `database`.

    Making one touches neither disk nor network; `start` does.
    """

    def __init__(self, settings: Settings) -> None:
        kinds = discover_kinds(settings.task_packages)
        self.settings = settings
        self.database = Database(settings.resolved_database_url)
        self.arrays = ArrayStore(settings.arrays_dir, settings.max_array_bytes, settings.disk_reserve_bytes)
        self.resources = ResourceRepository(self.database)
        self.hub = Hub()
        self._journal = Journal(self.database, self.hub)
        self._executor = LocalExecutor(self._journal, kinds, settings)
        self.ledger = Ledger(self.database, kinds, self._executor, self.hub)
        self.job_events = JobEvents(self.ledger, self.hub, settings.max_event_streams)
        self.readiness = Readiness(self.database, settings.data_dir, settings.disk_reserve_bytes)
        self._housekeeping = Housekeeping(self.database, settings.arrays_dir, settings.unused_days)
        self._started = False
        self._lock = DirectoryLock(settings.data_dir)

    def start(self) -> None:
        """Take the data directory, bring the tables up to date, go on with interrupted jobs; once only."""
        if self._started:
            return
        self.settings.data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._lock.acquire()
        try:
            self.arrays.prepare()
            self.database.migrate()
            observe(self.database.newest_identifier() or "0")
            self._journal.recover(self.settings.job_attempts)
        except BaseException:
            self._lock.release()
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
        self.database.close()
        self._lock.release()
