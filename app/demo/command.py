"""The command `lpv-oed demo`."""

import sys
from io import TextIOWrapper
from pathlib import Path

import typer
from rich.console import Console

from app.demo.run import run_demo
from identification.errors import MisuseError


def demo(folder: Path, seed: int) -> None:
    """Runs the demonstration on standard output, whatever characters that can show."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        run_demo(folder, seed, Console())
    except (MisuseError, OSError) as error:
        Console(stderr=True, highlight=False, markup=False).print(f"lpv-oed demo: {error}")
        raise typer.Exit(1) from error
