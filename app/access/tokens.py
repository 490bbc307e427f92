"""Named tokens, of which only hashes are kept; made, looked up and revoked while the service runs."""

import hashlib
import hmac
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from threading import Lock
from typing import Literal, cast

from sqlalchemy import or_, select
from typing_extensions import TypeAliasType

from app.errors import NotFoundError
from app.store.database import Database
from app.store.identifiers import is_identifier, new_identifier
from app.store.rows import TokenRow

Scope = TypeAliasType("Scope", Literal["read", "write", "admin"])
RANK: dict[str, int] = {"read": 0, "write": 1, "admin": 2}
PREFIX = "lpv_oed_"
SECONDS_REMEMBERED = 2.0


@dataclass(frozen=True)
class Caller:
    """Who asks, and what it may do."""

    name: str
    scope: Scope

    def may(self, scope: Scope) -> bool:
        return RANK[self.scope] >= RANK[scope]


@dataclass(frozen=True)
class TokenRecord:
    """A token without its secret."""

    id: str
    name: str
    scope: Scope
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None


class Tokens:
    """The token of the settings, who is the administrator, and the named ones in the database. Thread-safe."""

    def __init__(
        self, database: Database, administrator: str | None, clock: Callable[[], datetime] | None = None
    ) -> None:
        self._database = database
        self._administrator = None if administrator is None else _digest(administrator)
        self._now = clock or (lambda: datetime.now(UTC))
        self._lock = Lock()
        self._remembered: dict[str, tuple[float, Caller | None]] = {}

    def caller(self, secret: str) -> Caller | None:
        """Whose token this is, or None; what was looked up is remembered for two seconds, revoked ones no longer."""
        digest = _digest(secret)
        if self._administrator is not None and hmac.compare_digest(digest, self._administrator):
            return Caller("administrator", "admin")
        with self._lock:
            until, found = self._remembered.get(digest, (0.0, None))
        if time.monotonic() < until:
            return found
        found = self._look_up(digest)
        with self._lock:
            if len(self._remembered) > 10_000:
                self._remembered.clear()
            self._remembered[digest] = (time.monotonic() + SECONDS_REMEMBERED, found)
        return found

    def make(self, name: str, scope: Scope, lifetime: timedelta | None) -> tuple[TokenRecord, str]:
        """A new token and its secret, which is told this once."""
        secret = PREFIX + secrets.token_urlsafe(32)
        now = self._now()
        end = None if lifetime is None else now + lifetime
        row = TokenRow(
            id=new_identifier(), name=name, scope=scope, digest=_digest(secret), created_at=now, expires_at=end
        )
        with self._database.write() as session:
            session.add(row)
        return _record(row), secret

    def rotate(self, identifier: str, overlap: timedelta) -> tuple[TokenRecord, str]:
        """A new token like this one, which still works for `overlap`; raises NotFoundError when it does not work."""
        with self._database.write() as session:
            row = session.get(TokenRow, identifier) if is_identifier(identifier) else None
            if row is None or not self._works(row):
                raise NotFoundError(f"there is no token {identifier} that works")
            lifetime = None if row.expires_at is None else row.expires_at - row.created_at
            end = self._now() + overlap
            row.expires_at = end if row.expires_at is None else min(end, row.expires_at)
            name, scope = row.name, cast(Scope, row.scope)
        return self.make(name, scope, lifetime)

    def revoke(self, identifier: str) -> TokenRecord:
        """Let a token work no more; raises NotFoundError when there is none."""
        with self._database.write() as session:
            row = session.get(TokenRow, identifier) if is_identifier(identifier) else None
            if row is None:
                raise NotFoundError(f"there is no token {identifier}")
            row.revoked_at = row.revoked_at or self._now()
        with self._lock:
            self._remembered.clear()
        return _record(row)

    def list(self) -> list[TokenRecord]:
        """All tokens ever made, newest first."""
        with self._database.read() as session:
            return [_record(row) for row in session.scalars(select(TokenRow).order_by(TokenRow.id.desc()).limit(500))]

    def _look_up(self, digest: str) -> Caller | None:
        alive = or_(TokenRow.expires_at.is_(None), TokenRow.expires_at > self._now())
        query = select(TokenRow).where(TokenRow.digest == digest, TokenRow.revoked_at.is_(None), alive)
        with self._database.read() as session:
            row = session.scalars(query).one_or_none()
        return None if row is None else Caller(row.name, cast(Scope, row.scope))

    def _works(self, row: TokenRow) -> bool:
        return row.revoked_at is None and (row.expires_at is None or row.expires_at > self._now())


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode("latin-1", "replace")).hexdigest()


def _record(row: TokenRow) -> TokenRecord:
    return TokenRecord(row.id, row.name, cast(Scope, row.scope), row.created_at, row.expires_at, row.revoked_at)
