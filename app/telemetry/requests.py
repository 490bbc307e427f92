"""Every request gets an identifier, a line in the log and a place in the figures. Plain ASGI."""

import logging
import re
import time
from secrets import token_hex

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.telemetry.logs import about
from app.telemetry.metrics import Metrics

logger = logging.getLogger("app.requests")
GIVEN = re.compile(r"[A-Za-z0-9._-]{1,64}", re.ASCII)
HEADER = "X-Request-ID"


class Observed:
    """Outermost. Keeps the X-Request-ID that a proxy gives, or makes one, and answers with it."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        given = Headers(scope=scope).get(HEADER, "")
        identifier = given if GIVEN.fullmatch(given) else token_hex(8)
        began, status = time.perf_counter(), 0

        async def watched(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[HEADER] = identifier
            await send(message)

        with about(requestId=identifier):
            try:
                await self._app(scope, receive, watched)
            finally:
                self._answered(scope, status, time.perf_counter() - began)

    def _answered(self, scope: Scope, status: int, seconds: float) -> None:
        route = _route(scope)
        self._metrics.answered(scope["method"], route, status, seconds)
        milliseconds = round(1000 * seconds, 1)
        level = logging.DEBUG if route in ("/v1/health", "/v1/readiness", "/v1/metrics") else logging.INFO
        fields = {"method": scope["method"], "path": scope["path"], "status": status, "milliseconds": milliseconds}
        logger.log(level, "%s %r %s in %s ms", *fields.values(), extra=fields)


def _route(scope: Scope) -> str:
    """The path with the names of its parameters, so that there are few; "none" where there is no such route."""
    path = getattr(scope.get("route"), "path", None)
    if path is None:
        return "none"
    return f"/v1{path}" if scope["path"].startswith("/v1/") and not path.startswith("/v1/") else str(path)
