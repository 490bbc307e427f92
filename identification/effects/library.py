"""The library: every effect of this package, in the order of their kinds."""

from functools import cache

import identification.effects
from identification.places.place import Effect
from identification.places.variance import VarianceEffect
from identification.registry import discover


@cache
def variance_library() -> tuple[VarianceEffect, ...]:
    """An example of every effect that changes the variance and not the mean."""
    found = (cls for _, cls in sorted(discover(identification.effects).items()) if issubclass(cls, VarianceEffect))
    return tuple(cls.example() for cls in found)


@cache
def library(domain: str | None = None) -> tuple[Effect, ...]:
    """An example of every effect; with a `domain` ("mechanical", "impedance") those of it and the general ones."""
    every = (cls.example() for _, cls in sorted(discover(identification.effects).items()) if issubclass(cls, Effect))
    return tuple(one for one in every if domain is None or one.domain in (domain, "general"))
