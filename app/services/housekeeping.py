"""What is cleared away while the service runs."""

import logging
from pathlib import Path
from threading import Event, Thread

from app.store.database import Database
from app.store.unused import remove_unused

logger = logging.getLogger(__name__)
SECONDS_BETWEEN_ROUNDS = 3600.0
SECONDS_OF_A_DAY = 86_400.0


class Housekeeping:
    """Once an hour removes array files that nothing has named for `days`."""

    def __init__(self, database: Database, arrays: Path, days: float) -> None:
        self._database = database
        self._arrays = arrays
        self._seconds = days * SECONDS_OF_A_DAY
        self._stopping = Event()
        self._thread = Thread(target=self._loop, name="lpv-oed-housekeeping", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        self._stopping.set()

    def _loop(self) -> None:
        while not self._stopping.is_set():
            try:
                removed = remove_unused(self._database, self._arrays, self._seconds)
            except Exception as error:
                logger.warning("unused array files could not be removed: %s", error)
            else:
                if removed:
                    logger.info("%d bytes of unused array files were removed", removed)
            self._stopping.wait(SECONDS_BETWEEN_ROUNDS)
