"""Identifiers of resources and jobs: time-ordered, so that sorting by identifier is sorting by age."""

import re
import secrets
import threading
import time

_PATTERN = re.compile(r"[0-9a-f]{32}")
_RANDOM_BITS = 62


class _Clock:
    """Milliseconds and a counter that never run backwards, nor behind what was observed [Lamport's clock]."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last = 0

    def tick(self) -> int:
        """Sixty bits: 48 of milliseconds since 1970, then 12 that count within one."""
        with self._lock:
            self._last = max(time.time_ns() // 1_000_000 << 12, self._last + 1)
            return self._last

    def observe(self, tick: int) -> None:
        """Go on after a tick of elsewhere."""
        with self._lock:
            self._last = max(self._last, tick)


_clock = _Clock()


def new_identifier() -> str:
    """A UUID of version 7 [RFC 9562, section 5.7] as 32 hexadecimal digits."""
    tick = _clock.tick()
    value = (tick >> 12) << 80 | 0x7 << 76 | (tick & 0xFFF) << 64 | 0b10 << 62 | secrets.randbits(_RANDOM_BITS)
    return f"{value:032x}"


def observe(identifier: str) -> None:
    """Make all later identifiers of this process larger than this one, though the clock may have been set back."""
    value = int(identifier, 16)
    _clock.observe((value >> 80) << 12 | (value >> 64) & 0xFFF)


def is_identifier(text: str) -> bool:
    """Whether `text` can be an identifier at all."""
    return _PATTERN.fullmatch(text) is not None
