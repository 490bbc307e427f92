"""A worker: takes jobs from the database that servers share, and answers no requests."""

import logging
import signal
from threading import Event

from app.container import Container
from app.serve import end_in_time, settings_or_exit, start_or_exit
from app.telemetry.logs import set_up

logger = logging.getLogger(__name__)


def work() -> None:
    """Run jobs until SIGTERM or SIGINT; running ones are queued again and go on elsewhere.

    It takes part as a server does: it says by a lease that it lives, and what a dead one ran is queued again.
    """
    settings = settings_or_exit()
    container = Container(settings)
    if not container.database.is_shared:
        raise SystemExit("lpv-oed worker cannot start: LPV_OED_DATABASE_URL=postgresql://… of its servers is needed")
    if settings.workers == 0:
        raise SystemExit("lpv-oed worker cannot start: LPV_OED_WORKERS is 0; set how many jobs it runs at a time")
    set_up(settings.log_format)
    stopping = Event()
    for each in (signal.SIGTERM, signal.SIGINT):
        signal.signal(each, lambda *_: stopping.set())
    start_or_exit(container)
    logger.info("taking jobs, %d at a time", settings.workers)
    stopping.wait()
    end_in_time()
    container.stop()


if __name__ == "__main__":
    work()
