"""How a command says what is wrong with its request file."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, cast

import typer
from rich.console import Console

from app.errors import ProblemError
from app.json_pointer import field_pointer
from identification.errors import MisuseError

Rest = ParamSpec("Rest")


def explained(command: Callable[Concatenate[Path, Rest], None]) -> Callable[Concatenate[Path, Rest], None]:
    """A bad request ends the program with what is wrong and where, instead of a traceback."""

    @wraps(command)
    def run(file: Path, *rest: Rest.args, **named: Rest.kwargs) -> None:
        console = Console(stderr=True, highlight=False, markup=False)
        try:
            command(file, *rest, **named)
        except ProblemError as error:
            console.print(f"{file}: {error.detail}")
            for problem in error.errors:
                console.print(f"  {problem.pointer or '/'}: {problem.detail}")
        except MisuseError as error:
            console.print(f"{file}: {error}" + (f" ({field_pointer(error.field)})" if error.field else ""))
        else:
            return
        raise typer.Exit(1)

    return cast(Callable[Concatenate[Path, Rest], None], run)
