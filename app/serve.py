"""The server process."""

import errno
import os
import socket
import webbrowser
from functools import partial
from threading import Timer
from typing import Any

import uvicorn
from anyio.to_thread import run_sync
from fastapi import FastAPI
from pydantic import ValidationError
from pydantic_settings import SettingsError

from app.container import Container
from app.main import create_app
from app.protocol import PatientProtocol
from app.settings import Settings
from app.store.faults import fault_of
from app.store.lock import InUseError
from app.telemetry.logs import set_up

SECONDS_FOR_ANSWERS = 3
SECONDS_TO_STOP = 9.0
WHY_NOT = {
    "full": "the disk of the data directory is full; free some room below LPV_OED_DATA_DIR and start again",
    "unreachable": "the database cannot be reached; look at LPV_OED_DATABASE_URL and whether it runs",
    "damaged": "the database is damaged; put it aside and restore a backup with lpv-oed restore",
}


class Server(uvicorn.Server):
    """Stops within ten seconds of SIGTERM, whatever clients do: the jobs first, which are queued again, then the rest.

    What keeps it from starting, such as a full disk, ends the program with what to change.
    """

    def __init__(self, config: uvicorn.Config, application: FastAPI, opens: bool = False) -> None:
        super().__init__(config)
        self._container = application.state.container
        self._opens = opens

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await run_sync(start_or_exit, self._container)
        await super().startup(sockets)
        if self._opens and self.started:
            host = f"[{self.config.host}]" if ":" in self.config.host else self.config.host
            await run_sync(webbrowser.open, f"http://{host}:{self.config.port}")

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        end_in_time()
        await run_sync(self._container.stop_work)
        await super().shutdown(sockets)


def serve(opens: bool = False) -> None:
    """Serve until SIGTERM or SIGINT; running jobs are queued again and go on at the next start.

    Settings that are refused, and a port that is taken, end the program with what to change. `opens`: show the
    workbench in the browser once it answers.
    """
    settings = settings_or_exit()
    require_free(settings.host, settings.port)
    set_up(settings.log_format)
    application = create_app(settings)
    protocol: Any = partial(PatientProtocol, head_seconds=settings.request_seconds)
    config = uvicorn.Config(
        application,
        host=settings.host,
        port=settings.port,
        http=protocol,
        access_log=False,
        log_config=None,
        timeout_graceful_shutdown=SECONDS_FOR_ANSWERS,
    )
    Server(config, application, opens).run()


def start_or_exit(container: Container) -> None:
    """Starts what the service is made of; ends the program with what to change where that cannot be."""
    try:
        container.start()
    except Exception as error:
        reason = why_not_started(error)
        if reason is None:
            raise
        raise SystemExit(f"lpv-oed cannot start: {reason}") from None


def end_in_time() -> None:
    """Ends the process within ten seconds, however far it comes; all that was acknowledged survives that as well."""
    end = Timer(SECONDS_TO_STOP, os._exit, [1])
    end.daemon = True
    end.start()


def require_free(host: str, port: int) -> None:
    """Ends the program where nothing can listen at an address, saying why."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        with socket.socket(family) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            reason = f"another program listens on port {port} of {host}; stop it, or choose another port with --port"
        else:
            reason = f"port {port} of {host} cannot be listened on ({error.strerror}); choose others with --port"
        raise SystemExit(f"lpv-oed cannot start: {reason}") from None


def why_not_started(error: Exception) -> str | None:
    """What keeps the service from starting and what to do, where it is not a fault of the program."""
    fault = fault_of(error)
    if fault is not None:
        return WHY_NOT[fault]
    if isinstance(error, InUseError | OSError):
        return str(error)
    return None


def settings_or_exit() -> Settings:
    """The settings of the environment; ends the program with what to change when they are refused."""
    try:
        return Settings()
    except ValidationError as error:
        raise SystemExit("\n".join(_explained(error))) from None
    except SettingsError as error:
        raise SystemExit(str(error)) from None


def _explained(error: ValidationError) -> list[str]:
    prefix = Settings.model_config["env_prefix"]
    lines = []
    for failure in error.errors(include_input=False, include_url=False):
        message = str(failure.get("ctx", {}).get("error", failure["msg"]))
        lines.append(": ".join([*(f"{prefix}{name}".upper() for name in failure["loc"]), message]))
    return lines


if __name__ == "__main__":
    serve()
