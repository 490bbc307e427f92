"""Documents of tokens and of the audit."""

from typing import Self

from pydantic import Field

from app.access.audit import AuditRecord
from app.access.tokens import Scope, TokenRecord
from app.schemas.common import CamelModel, Double, Integer, Timestamp


class TokenRequest(CamelModel):
    """A token to be made."""

    name: str = Field(min_length=1, max_length=100, description="whose it is or what it is for; told in the audit")
    scope: Scope = Field(description="read: look; write: also make and cancel; admin: also tokens and the audit")
    lifetime_days: Double | None = Field(default=None, gt=0, le=36500, description="until it expires; never without")


class TokenRotation(CamelModel):
    """How a token is to be replaced by a new one."""

    overlap_hours: Double = Field(default=24.0, ge=0, le=8760, description="how long the old one still works")


class Token(CamelModel):
    """A token without its secret."""

    id: str
    name: str
    scope: Scope
    created_at: Timestamp
    expires_at: Timestamp | None = None
    revoked_at: Timestamp | None = None

    @classmethod
    def of(cls, record: TokenRecord) -> Self:
        """The document of a token."""
        return cls(**vars(record))


class NewToken(CamelModel):
    """A token with its secret, which is told this once."""

    token: Token
    secret: str = Field(description="what to send as Authorization: Bearer …; it cannot be read again")


class TokenList(CamelModel):
    """All tokens, newest first."""

    items: list[Token]


class AuditLine(CamelModel):
    """One request that was to make, change or end something, and its answer."""

    id: str
    at: Timestamp
    who: str = Field(description="name of the token")
    method: str
    path: str
    status: Integer
    request_id: str

    @classmethod
    def of(cls, record: AuditRecord) -> Self:
        """The document of a line."""
        return cls(**vars(record))


class AuditPage(CamelModel):
    """Part of the audit, newest first."""

    items: list[AuditLine]
    next_cursor: str | None = Field(default=None, description="continues the list; absent at its end")
