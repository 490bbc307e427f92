"""Guards in front of the routes: who is asking, from where, and how much is sent. Plain ASGI."""

import asyncio
import logging
import time
from urllib.parse import urlsplit

from anyio import move_on_after
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.errors import (
    BadRequestError,
    ContentTooLargeError,
    ForbiddenError,
    ProblemError,
    TooSlowError,
)
from app.problem_handlers import answer, answer_to_fault
from app.settings import is_loopback
from app.store.faults import fault_of

logger = logging.getLogger(__name__)
SLOWEST_BYTES_PER_SECOND = 16 * 1024
MOST_TAKEN_IN = 4 * 1024**3  # bytes of a refused body
TOO_SLOW = "the body did not come in time; send it faster, or raise LPV_OED_REQUEST_SECONDS"


class Guard:
    """Base of the guards: refuses a request with a problem, or passes it on."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        try:
            self.check(scope, Headers(scope=scope))
        except ProblemError as refusal:
            return await answer(refusal, scope["path"])(scope, receive, self.answerer(scope, receive, send))
        await self._app(scope, self.receiver(receive), send)

    def check(self, scope: Scope, headers: Headers) -> None:
        """Raise ProblemError to refuse the request."""

    def receiver(self, receive: Receive) -> Receive:
        """What the application reads the body from."""
        return receive

    def answerer(self, scope: Scope, receive: Receive, send: Send) -> Send:
        """What a refusal is sent with."""
        return send


class FaultGuard:
    """The outermost: what no handler knows is written into the log and answered, and the connection goes on."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        begun = False

        async def watched(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        try:
            await self._app(scope, receive, watched)
        except Exception as fault:
            if begun:
                raise  # what was sent is no whole answer, so the connection must end
            known = fault_of(fault) is not None
            logger.error("%s %r failed: %s", scope["method"], scope["path"], fault, exc_info=None if known else fault)
            await answer_to_fault(fault, scope["path"])(scope, receive, send)


class LoopbackGuard(Guard):
    """Without a token only this machine is served, and no web page of elsewhere can reach through a browser.

    Refuses connections to other addresses of this machine, names in Host that are not loopback (a name of elsewhere
    may be made to resolve to 127.0.0.1), and origins that are not loopback.
    """

    def check(self, scope: Scope, headers: Headers) -> None:
        address = (scope.get("server") or ("", None))[0]
        if _is_address(address) and not is_loopback(address):
            raise ForbiddenError("without a token the service answers on the loopback address only")
        host = headers.get("host", "")
        if not is_loopback(_name(f"//{host}")):
            raise BadRequestError(f"the Host {host!r} is not this machine; ask for 127.0.0.1 or localhost")
        origin = headers.get("origin")
        if origin is not None and not is_loopback(_name(origin)):
            raise ForbiddenError(f"requests of the origin {origin!r} are not answered")


class BodyGuard(Guard):
    """Refuses a body beyond the limit, by its announced length or as soon as more has come in, or that is too slow.

    A body may take `seconds` and a second more for every SLOWEST_BYTES_PER_SECOND of it that have come.
    """

    def __init__(self, app: ASGIApp, most_bytes: int, seconds: float) -> None:
        super().__init__(app)
        self._most_bytes = most_bytes
        self._seconds = seconds

    @property
    def _refusal(self) -> str:
        return f"the body is larger than {self._most_bytes} bytes; send less or raise LPV_OED_MAX_BODY_BYTES"

    def check(self, scope: Scope, headers: Headers) -> None:
        if _announced(headers) > self._most_bytes:
            raise ContentTooLargeError(self._refusal)

    def answerer(self, scope: Scope, receive: Receive, send: Send) -> Send:
        """Answers at once, then takes in what was announced (not without end), or the sender might see no answer."""
        headers = Headers(scope=scope)
        if not self._most_bytes < _announced(headers) <= MOST_TAKEN_IN or "expect" in headers:
            return send

        async def patient(message: Message) -> None:
            if message["type"] != "http.response.body" or message.get("more_body"):
                return await send(message)
            await send({**message, "more_body": True})
            with move_on_after(self._seconds):
                while (await receive()).get("more_body"):
                    pass
            await send({"type": "http.response.body", "body": b""})

        return patient

    def receiver(self, receive: Receive) -> Receive:
        received = 0
        complete = False
        began = time.monotonic()

        async def limited() -> Message:
            nonlocal received, complete
            if complete:
                return await receive()
            end = began + self._seconds + received / SLOWEST_BYTES_PER_SECOND
            try:
                message = await asyncio.wait_for(receive(), end - time.monotonic())
            except TimeoutError:
                raise HTTPException(TooSlowError.status, TOO_SLOW, {"Connection": "close"}) from None
            received += len(message.get("body", b""))
            complete = not message.get("more_body", False)
            if received > self._most_bytes:
                raise HTTPException(ContentTooLargeError.status, self._refusal)
            return message

        return limited


def _announced(headers: Headers) -> int:
    """The length of the body that the sender announced, 0 where it did not."""
    announced = headers.get("content-length", "0")
    return int(announced) if announced.isdecimal() else 0


def _is_address(text: str) -> bool:
    return text.replace(".", "").isdigit() or ":" in text


def _name(url: str) -> str:
    try:
        return urlsplit(url).hostname or ""
    except ValueError:
        return ""
