"""Those who guess tokens wait."""

import time
from collections import OrderedDict
from collections.abc import Callable

MOST_FAILURES = 20
SECONDS = 60.0
MOST_ADDRESSES = 10_000


class Throttle:
    """Counts wrong tokens by address; right ones are never in question. Belongs to one event loop."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._failures: OrderedDict[str, tuple[float, int]] = OrderedDict()

    def failed(self, address: str) -> bool:
        """One more wrong token; whether there were too many within a minute."""
        now = self._clock()
        began, count = self._failures.pop(address, (now, 0))
        if now - began > SECONDS:
            began, count = now, 0
        self._failures[address] = (began, count + 1)
        if len(self._failures) > MOST_ADDRESSES:
            self._failures.popitem(last=False)
        return count + 1 > MOST_FAILURES
