"""Tokens and the audit, for administrators."""

from datetime import timedelta

from fastapi import APIRouter, Response

from app.container import Container
from app.dependencies import ContainerDependency, Cursor, Limit
from app.errors import ConflictError
from app.schemas.access import AuditLine, AuditPage, NewToken, Token, TokenList, TokenRequest, TokenRotation

router = APIRouter(tags=["access"])
UNUSED = {409: {"description": "The server asks for no token"}}


@router.post("/tokens", status_code=201, responses=UNUSED)  # type: ignore[arg-type]
def create_token(body: TokenRequest, container: ContainerDependency, response: Response) -> NewToken:
    """Make a named token; its secret is in this answer and nowhere else."""
    _require_guard(container)
    lifetime = None if body.lifetime_days is None else timedelta(days=body.lifetime_days)
    record, secret = container.tokens.make(body.name, body.scope, lifetime)
    response.headers["Cache-Control"] = "no-store"
    return NewToken(token=Token.of(record), secret=secret)


@router.get("/tokens")
def list_tokens(container: ContainerDependency) -> TokenList:
    """All tokens, also expired and revoked ones."""
    return TokenList(items=[Token.of(record) for record in container.tokens.list()])


@router.post("/tokens/{tokenId}/rotation", status_code=201)
def rotate_token(tokenId: str, body: TokenRotation, container: ContainerDependency, response: Response) -> NewToken:
    """A new token with the name and scope of this one, which still works for a while."""
    record, secret = container.tokens.rotate(tokenId, timedelta(hours=body.overlap_hours))
    response.headers["Cache-Control"] = "no-store"
    return NewToken(token=Token.of(record), secret=secret)


@router.post("/tokens/{tokenId}/revocation")
def revoke_token(tokenId: str, container: ContainerDependency) -> Token:
    """Let a token work no more: at once on this server, within seconds on others."""
    return Token.of(container.tokens.revoke(tokenId))


@router.get("/audit")
def list_audit(container: ContainerDependency, limit: Limit = 50, cursor: Cursor = None) -> AuditPage:
    """Who asked to make, change or end what, newest first; kept where the server asks for a token."""
    page = container.audit.list(limit, cursor)
    return AuditPage(items=[AuditLine.of(record) for record in page.items], next_cursor=page.next_cursor)


def _require_guard(container: Container) -> None:
    if container.settings.bearer_token is None:
        raise ConflictError("this server asks for no token; set LPV_OED_TOKEN, which is that of the administrator")
