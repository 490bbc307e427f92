"""How long tests wait: until it has happened, however busy the machine is; only what hangs is given up."""

import time
from collections.abc import Callable
from typing import TypeVar

Found = TypeVar("Found")

PATIENCE = 1200.0
"""Seconds. No test may pass or fail by it but one that would never end."""


def until(condition: Callable[[], Found], what: object = "it", between: float = 0.02) -> Found:
    """What `condition` returns once that is true; AssertionError, with `what` was waited for, when it never is."""
    end = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < end, f"waited in vain for {what() if callable(what) else what}"
        time.sleep(between)
    return found
