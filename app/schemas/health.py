"""Documents of the state of the service."""

from typing import Literal

from app.schemas.common import CamelModel


class Health(CamelModel):
    """The process is alive."""

    status: Literal["ok"] = "ok"
    version: str


class Readiness(CamelModel):
    """The service can take in work."""

    status: Literal["ready"] = "ready"
    version: str
