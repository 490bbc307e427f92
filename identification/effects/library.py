"""The library: every effect of this package, in the order of their kinds."""

from functools import cache

import identification.effects
from identification.places.place import Effect
from identification.registry import discover


@cache
def library(domain: str | None = None) -> tuple[Effect, ...]:
    """An example of every effect; with a `domain` ("mechanical", "impedance") those of it and the general ones."""
    every = (cls.example() for _, cls in sorted(discover(identification.effects).items()))
    return tuple(one for one in every if domain is None or one.domain in (domain, "general"))
