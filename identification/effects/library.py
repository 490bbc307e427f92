"""The library: every effect of this package, in the order of their kinds."""

from functools import cache

import identification.effects
from identification.places.place import Effect
from identification.registry import discover


@cache
def library() -> tuple[Effect, ...]:
    """An example of every effect."""
    return tuple(cls.example() for _, cls in sorted(discover(identification.effects).items()))
