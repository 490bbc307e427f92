"""Walks the loop with a plant of every structure and writes README's table: python -m benchmarks.structure_table."""

from pathlib import Path
from tempfile import TemporaryDirectory

from tests.support.api import Api
from tests.support.loop_table import keep, walked
from tests.support.server import running_server


def main() -> None:
    """A server of its own, every cell, the table."""
    with TemporaryDirectory() as folder, running_server(Path(folder) / "data") as server:
        text = walked(Api(server.url))
    keep(text)
    print(text)


if __name__ == "__main__":
    main()
