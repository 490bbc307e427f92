"""The kinds of hidden things, one function each; a module's public functions are its kinds."""

from collections.abc import Callable
from importlib import import_module
from inspect import getmembers, isfunction
from pkgutil import iter_modules

import numpy as np

from benchmarks.campaigns.campaign import Campaign

Kind = Callable[[str, np.random.Generator], Campaign]


def kinds() -> dict[str, Kind]:
    """Every kind by its name."""
    found: dict[str, Kind] = {}
    for each in iter_modules(__path__):
        module = import_module(f"{__name__}.{each.name}")
        own = getmembers(module, lambda f: isfunction(f) and f.__module__ == module.__name__)  # noqa: B023
        found |= {name: f for name, f in own if not name.startswith("_")}
    return dict(sorted(found.items()))
