"""HTTP over one connection, which ends when the head of a request does not come in time."""

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from app.errors import BadRequestError, ProblemError, TooSlowError, problem_response

TOO_SLOW = "the head of the request did not come in time"


class PatientProtocol(H11Protocol):
    """Waits `head_seconds` for the whole head of a request, from the start or from the end of the last answer."""

    def __init__(self, *arguments: Any, head_seconds: float, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._head_seconds = head_seconds
        self._deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        self._forget()

    def handle_events(self) -> None:
        super().handle_events()
        self._watch()

    def on_response_complete(self) -> None:
        self._forget()
        super().on_response_complete()
        self._watch()

    def send_400_response(self, msg: str) -> None:
        self._refuse(BadRequestError("this is no HTTP request"))

    def _watch(self) -> None:
        answering = self.cycle is not None and not self.cycle.response_complete
        if answering or self.transport.is_closing():
            self._forget()
        elif self._deadline is None:
            self._deadline = self.loop.call_later(self._head_seconds, self._give_up)

    def _forget(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _give_up(self) -> None:
        self._deadline = None
        if not self.transport.is_closing():
            self._refuse(TooSlowError(TOO_SLOW))

    def _refuse(self, error: ProblemError) -> None:
        """Answer outside of any request, if none is half answered, and end the connection."""
        if self.cycle is None or self.cycle.response_complete:
            response = problem_response(error.problem(), {"connection": "close"})
            head = [b"%s: %s" % pair for pair in response.raw_headers]
            status = b"HTTP/1.1 %d %s" % (error.status, error.title.encode())
            self.transport.write(b"\r\n".join([status, *head, b"", response.body]))
        self.transport.close()
