"""Discovery of plug-ins: one module of a package, one class with a `kind`."""

import importlib
import pkgutil
from collections.abc import Mapping
from types import MappingProxyType, ModuleType
from typing import Any


def discover(package: ModuleType) -> Mapping[str, type[Any]]:
    """The plug-in classes of a package by their `kind`, in the order of their names, immutable.

    A plug-in is a class with a class attribute `kind` that is defined (not merely imported) in a module directly
    inside `package`. Raises ValueError when two of them claim the same kind.
    """
    found: dict[str, type[Any]] = {}
    for info in sorted(pkgutil.iter_modules(package.__path__), key=lambda item: item.name):
        module = importlib.import_module(f"{package.__name__}.{info.name}")
        for plug_in in _plug_ins(module):
            other = found.setdefault(plug_in.kind, plug_in)
            if other is not plug_in:
                raise ValueError(f"kind {plug_in.kind!r} is claimed by both {other.__module__} and {module.__name__}")
    return MappingProxyType(found)


def _plug_ins(module: ModuleType) -> list[type[Any]]:
    return [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and value.__module__ == module.__name__
        and isinstance(getattr(value, "kind", None), str)
    ]
