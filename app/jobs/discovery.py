"""Which kinds of jobs there are: the modules of the task packages, found without importing them."""

import pkgutil
from collections.abc import Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import cast

from app.jobs.task import TaskModule


def discover_kinds(packages: Sequence[str]) -> Mapping[str, str]:
    """Kinds of jobs and the modules that do them; raises ValueError when two packages have the same kind."""
    kinds: dict[str, str] = {}
    for package in packages:
        for module in pkgutil.iter_modules(import_module(package).__path__):
            if module.name in kinds:
                raise ValueError(f"the job kind {module.name!r} is in {kinds[module.name]} and in {package}")
            kinds[module.name] = f"{package}.{module.name}"
    return MappingProxyType(kinds)


def load_task(module_name: str) -> TaskModule:
    """The task in a module; raises TypeError when the module is none or its KIND is not its name."""
    module = import_module(module_name)
    kind = module_name.rpartition(".")[2]
    if getattr(module, "KIND", None) != kind or not callable(getattr(module, "run", None)):
        raise TypeError(f"{module_name} must have KIND = {kind!r} and a function run(payload, context)")
    return cast(TaskModule, module)
