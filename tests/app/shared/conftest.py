"""A PostgreSQL for the tests of several servers; they are skipped, loudly, where there is none."""

from collections.abc import Iterator
from importlib.util import find_spec

import pytest

from tests.support.postgres import MISSING, Postgres, program, running_postgres


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    skipped = [report for report in terminalreporter.stats.get("skipped", []) if MISSING in str(report.longrepr)]
    if skipped:
        terminalreporter.write_line(f"{len(skipped)} TESTS OF SEVERAL SERVERS WERE NOT RUN: {MISSING}", red=True)


@pytest.fixture(scope="package")
def postgres() -> Iterator[Postgres]:
    if program("initdb") is None or find_spec("psycopg") is None:
        pytest.skip(MISSING)
    with running_postgres() as running:
        yield running
