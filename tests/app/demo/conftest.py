"""One walk through the demonstration, shared by its tests."""

import io
from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from rich.console import Console

from app.demo.run import STEPS, tell
from app.demo.story import Story
from app.demo.terminal import Terminal
from app.offline.workplace import workplace


@dataclass(frozen=True)
class Told:
    """The story and what the terminal showed of it."""

    story: Story
    shown: str


@pytest.fixture(scope="session")
def told() -> Iterator[Told]:
    """The story of the first seed, written to a pipe 100 characters wide."""
    console = Console(file=io.StringIO(), width=100)
    with workplace(Console(quiet=True)) as place:
        story = tell(1, Terminal(console, STEPS), place)
        assert isinstance(console.file, io.StringIO)
        yield Told(story, console.file.getvalue())
