"""Every request but those to open paths must carry a token whose scope allows it. Plain ASGI."""

from anyio.to_thread import run_sync
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.access.audit import Audit
from app.access.throttle import MOST_FAILURES, SECONDS, Throttle
from app.access.tokens import Caller, Tokens
from app.access.tokens import Scope as TokenScope
from app.errors import ForbiddenError, ProblemError, TooManyRequestsError, UnauthorizedError
from app.pages.security import is_page
from app.problem_handlers import answer
from app.telemetry.logs import about, about_now

OPEN_PATHS = ("/v1/health", "/v1/readiness")
ADMINISTRATION = ("/v1/tokens", "/v1/audit")
SAFE = ("GET", "HEAD", "OPTIONS")


class TokenGuard:
    """Refuses with 401 without a token, 403 beyond its scope, 429 after too many wrong ones; audits the rest."""

    def __init__(self, app: ASGIApp, tokens: Tokens, audit: Audit) -> None:
        self._app = app
        self._tokens = tokens
        self._audit = audit
        self._throttle = Throttle()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["path"] in OPEN_PATHS or is_page(scope["path"]):
            return await self._app(scope, receive, send)
        try:
            caller = await self._caller(scope)
            _require(caller, scope)
        except ProblemError as refusal:
            return await answer(refusal, scope["path"])(scope, receive, send)
        with about(who=caller.name):
            await self._audited(caller, scope, receive, send)

    async def _caller(self, scope: Scope) -> Caller:
        scheme, _, given = Headers(scope=scope).get("authorization", "").partition(" ")
        secret = given.strip() if scheme.lower() == "bearer" else ""
        caller = await run_sync(self._tokens.caller, secret) if secret else None
        if caller is not None:
            return caller
        if secret and self._throttle.failed((scope.get("client") or ("",))[0]):
            raise TooManyRequestsError(
                f"more than {MOST_FAILURES} wrong tokens came from this address within {SECONDS:.0f} s; wait",
                headers={"Retry-After": f"{SECONDS:.0f}"},
            )
        raise UnauthorizedError(
            "send the header Authorization: Bearer <token> with a token of this server that has not expired",
            headers={"WWW-Authenticate": "Bearer"},
        )

    async def _audited(self, caller: Caller, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["method"] in SAFE:
            return await self._app(scope, receive, send)
        status = 500

        async def watched(message: Message) -> None:
            nonlocal status
            status = message.get("status", status)
            await send(message)

        try:
            await self._app(scope, receive, watched)
        finally:
            request_id = about_now().get("requestId", "")
            await run_sync(self._audit.add, caller.name, scope["method"], scope["path"], status, request_id)


def _require(caller: Caller, scope: Scope) -> None:
    needed: TokenScope = "read" if scope["method"] in SAFE else "write"
    if scope["path"].startswith(ADMINISTRATION):
        needed = "admin"
    if not caller.may(needed):
        raise ForbiddenError(f"the token {caller.name!r} has the scope {caller.scope}, this needs {needed}")
