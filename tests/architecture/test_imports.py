"""Imports run one way, app → oed → identification, and modules do not load each other in circles."""

from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tests.support.sources import PACKAGES, Source, all_sources, parse, sources

RANK = {package: rank for rank, package in enumerate(PACKAGES)}

# The numeric packages know nothing of the service: no HTTP, no database, no files of settings, no clock.
SERVICE_ONLY = {
    *("alembic", "datetime", "fastapi", "http", "httpx", "jinja2", "pebble", "plotly", "pydantic", "pydantic_settings"),
    *(
        "requests",
        "rich",
        "socket",
        "sqlalchemy",
        "sqlite3",
        "starlette",
        "subprocess",
        "time",
        "typer",
    ),
    *("urllib", "uvicorn", "yaml"),
}


def against_the_direction(source: Source) -> list[str]:
    own = RANK[source.module.split(".")[0]]
    return [f"{source.path}:{n} {name}" for n, name in source.imports() if RANK.get(name.split(".")[0], -1) > own]


def of_the_service(source: Source) -> list[str]:
    return [f"{source.path}:{n} {name}" for n, name in source.imports() if name.split(".")[0] in SERVICE_ONLY]


def loads(source: Source, modules: set[str]) -> set[str]:
    """The project's modules that importing this one loads by name."""
    found = set()
    for _, name in source.imports(when_loaded=True):
        target = name if name in modules else name.rpartition(".")[0]
        if target in modules:
            found.add(target)
    return found - {source.module}


def cycle(all_of_them: tuple[Source, ...]) -> list[str]:
    modules = {source.module for source in all_of_them}
    try:
        TopologicalSorter({source.module: loads(source, modules) for source in all_of_them}).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_run_one_way(package: str) -> None:
    assert [line for source in sources(package) for line in against_the_direction(source)] == []


@pytest.mark.parametrize("package", ["identification", "oed"])
def test_the_numeric_packages_know_nothing_of_the_service(package: str) -> None:
    assert sources(package)
    assert [line for source in sources(package) for line in of_the_service(source)] == []


def test_modules_do_not_load_each_other_in_circles() -> None:
    assert cycle(all_sources()) == []


def test_an_import_against_the_direction_is_seen_wherever_it_stands() -> None:
    hidden = "def f():\n    if True:\n        from app.settings import Settings\n"
    source = parse("identification.lti.bad", Path("identification/lti/bad.py"), hidden)
    assert against_the_direction(source) == ["identification/lti/bad.py:3 app.settings.Settings"]
    relative = parse("oed.targets.bad", Path("oed/targets/bad.py"), "from ...app import main\n")
    assert against_the_direction(relative) == ["oed/targets/bad.py:1 app.main"]


def test_a_circle_is_seen() -> None:
    one = parse("oed.one", Path("oed/one.py"), "from oed.two import g\n")
    two = parse("oed.two", Path("oed/two.py"), "from . import one\n")
    late = parse("oed.two", Path("oed/two.py"), "def g():\n    from . import one\n")
    assert set(cycle((one, two))) == {"oed.one", "oed.two"}
    assert cycle((one, late)) == []
