"""Log lines, as text or as one JSON object each, with the request and the job that they are about."""

import json
import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any, Literal

LogFormat = Literal["text", "json"]
FIELDS = ("method", "path", "status", "milliseconds")
_about: ContextVar[dict[str, str] | None] = ContextVar("about", default=None)


@contextmanager
def about(**names: str) -> Iterator[None]:
    """All lines written within the block, in this thread or task, carry these names, such as requestId and jobId."""
    token = _about.set({**(_about.get() or {}), **names})
    try:
        yield
    finally:
        _about.reset(token)


def about_now() -> dict[str, str]:
    """What lines carry that are written now."""
    return _about.get() or {}


class JsonFormatter(logging.Formatter):
    """One JSON object a line: time, level, logger, message, and what the line is about."""

    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **getattr(record, "about", {}),
            **{name: getattr(record, name) for name in FIELDS if hasattr(record, name)},
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=True, default=str)


class TextFormatter(logging.Formatter):
    """`INFO:     message [requestId=…]`, as servers write them."""

    def format(self, record: logging.LogRecord) -> str:
        names = " ".join(f"{name}={value}" for name, value in getattr(record, "about", {}).items())
        head = f"{record.levelname}:".ljust(10) + _one_line(record.getMessage())
        trace = f"\n{self.formatException(record.exc_info)}" if record.exc_info else ""
        return head + (f" [{names}]" if names else "") + trace


class AboutFilter(logging.Filter):
    """Notes in a record what it is about, in the thread or task that writes it."""

    def filter(self, record: logging.LogRecord) -> bool:
        record.about = about_now()
        return True


def set_up(log_format: LogFormat) -> None:
    """Send all lines of this process to its standard error."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonFormatter() if log_format == "json" else TextFormatter())
    handler.addFilter(AboutFilter())
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.getLogger("alembic").setLevel(logging.WARNING)


def _one_line(text: str) -> str:
    """No request can begin a line of the log; the traceback of a job keeps its lines, indented."""
    return text.replace("\r", "\\r").replace("\n", "\n    ")
