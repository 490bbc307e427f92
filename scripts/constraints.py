"""Print constraints.txt: the version installed here of everything that the project needs, directly or not."""

import sys
import tomllib
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]


def project_requirements() -> list[Requirement]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return [Requirement(text) for text in project["dependencies"] + project["optional-dependencies"]["dev"]]


def applies(requirement: Requirement, extras: set[str]) -> bool:
    return requirement.marker is None or any(requirement.marker.evaluate({"extra": e}) for e in extras or {""})


def needed(requirements: list[Requirement], extras: set[str]) -> Iterator[tuple[str, set[str]]]:
    for requirement in requirements:
        if applies(requirement, extras):
            yield str(canonicalize_name(requirement.name)), set(requirement.extras)


def closure() -> dict[str, str]:
    """Name and version of every distribution that the project needs, directly or not."""
    waiting, pins, seen = (
        list(needed(project_requirements(), set())),
        dict[str, str](),
        set[tuple[str, frozenset[str]]](),
    )
    while waiting:
        name, extras = waiting.pop()
        if (name, frozenset(extras)) in seen:
            continue
        seen.add((name, frozenset(extras)))
        distribution = metadata.distribution(name)
        pins[name] = distribution.version
        waiting += needed([Requirement(text) for text in distribution.requires or []], extras)
    return pins


def main() -> None:
    lines = ["# Versions that are known to work together; written by `make constraints`, used by every installation."]
    lines += [f"{name}=={version}" for name, version in sorted(closure().items())]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
