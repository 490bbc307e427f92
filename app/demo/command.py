"""The command `lpv-oed demo`."""

import sys
from io import TextIOWrapper
from pathlib import Path

import typer
from rich.console import Console

from app.demo.run import run_demo
from app.virtual_plant.hidden import EFFECTS
from identification.errors import MisuseError


def demo(folder: Path, seed: int, hidden: str) -> None:
    """Runs the demonstration on standard output, whatever characters that can show."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        if hidden not in ("none", *EFFECTS):
            raise MisuseError(f"the stage cannot hide {hidden}; choose none, {', '.join(EFFECTS)}", "hidden")
        run_demo(folder, seed, Console(), hidden)
    except (MisuseError, OSError) as error:
        Console(stderr=True, highlight=False, markup=False).print(f"lpv-oed demo: {error}")
        raise typer.Exit(1) from error
