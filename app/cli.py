"""The command line: one function a command; what it needs is imported when it is called."""

import os
from pathlib import Path
from typing import Annotated

import typer

application = typer.Typer(
    name="lpv-oed",
    help="Design, measure and identify linear parameter-varying systems with the least input energy.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

RequestFile = Annotated[
    Path, typer.Argument(exists=True, dir_okay=False, readable=True, help="YAML or JSON, see examples/")
]
Output = Annotated[
    Path | None, typer.Option("--output", "-o", help="folder for the results; default: beside FILE, named after it")
]

Report = Annotated[Path | None, typer.Option("--report", dir_okay=False, help="write the figures as one HTML file")]


def _show_version(wanted: bool) -> None:
    if wanted:
        from app import __version__

        typer.echo(f"lpv-oed {__version__}")
        raise typer.Exit


@application.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="say the version and end")
    ] = False,
) -> None:
    """What all commands share."""


@application.command()
def serve(
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="port to listen on; default: 8000")] = None,
    host: Annotated[str | None, typer.Option(help="address to listen on; beyond 127.0.0.1 with LPV_OED_TOKEN")] = None,
    data_dir: Annotated[Path | None, typer.Option(help="directory of all that is kept; default: lpv-oed-data")] = None,
    opens: Annotated[bool, typer.Option("--open", help="show the workbench in the browser")] = False,
) -> None:
    """Start the service; LPV_OED_HOST, LPV_OED_PORT and the other LPV_OED_ variables set it up where options do not."""
    for name, value in (("PORT", port), ("HOST", host), ("DATA_DIR", data_dir)):
        if value is not None:
            os.environ[f"LPV_OED_{name}"] = str(value)
    from app.serve import serve as run

    run(opens)


@application.command()
def worker() -> None:
    """Run jobs of the servers that share LPV_OED_DATABASE_URL (PostgreSQL) and LPV_OED_DATA_DIR, without HTTP."""
    from app.work import work as run

    run()


@application.command()
def design(file: RequestFile, output: Output = None, report: Report = None) -> None:
    """Design experiments without a server; FILE has plant, model, design and, if wanted, signals."""
    from app.offline.commands import design as run

    run(file, output or file.with_name(f"{file.stem}-designed"), report)


@application.command()
def identify(file: RequestFile, output: Output = None, report: Report = None) -> None:
    """Identify a model without a server; FILE has plant, experiments (data or data files) and model."""
    from app.offline.commands import identify as run

    run(file, output or file.with_name(f"{file.stem}-identified"), report)


@application.command()
def compare(file: RequestFile, output: Output = None, report: Report = None) -> None:
    """See where a model fails; FILE has plant, model and experiments, held-out ones marked `heldOut: true`."""
    from app.offline.loop_commands import compare as run

    run(file, output or file.with_name(f"{file.stem}-compared"), report)


@application.command()
def diagnose(
    file: RequestFile,
    output: Output = None,
    add: Annotated[bool, typer.Option("--add", help="add the best effect to the model and fit it again")] = False,
    report: Report = None,
) -> None:
    """Find the physical effect that a model lacks; FILE as for compare."""
    from app.offline.loop_commands import diagnose as run

    run(file, output or file.with_name(f"{file.stem}-diagnosed"), add, report)


@application.command()
def extend(file: RequestFile, output: Output = None, report: Report = None) -> None:
    """Add an effect to a model and fit it again; FILE as for compare, and `extend: {effect: …}`."""
    from app.offline.loop_commands import extend as run

    run(file, output or file.with_name(f"{file.stem}-extended"), report)


@application.command()
def demo(
    output: Annotated[Path, typer.Option("--output", "-o", help="folder for the report")] = Path("lpv-oed-demo"),
    seed: Annotated[int, typer.Option(min=0, help="of the noise; the same seed gives the same report")] = 1,
    hidden: Annotated[
        str, typer.Option(help="what the plant does that its model does not know, such as delay, or none")
    ] = "cubic_stiffness",
) -> None:
    """Walk the whole loop on a simulated plant with an effect hidden in it; leaves an HTML report."""
    from app.demo.command import demo as run

    run(output, seed, hidden)


@application.command()
def backup(
    target: Annotated[Path, typer.Argument(file_okay=False, help="folder of the backup; a later one only adds to it")],
) -> None:
    """Copy the data directory (LPV_OED_DATA_DIR) to TARGET, also while the service runs."""
    from app.backups import backup as run

    run(target)


@application.command()
def restore(
    source: Annotated[Path, typer.Argument(exists=True, file_okay=False, help="folder of a backup")],
) -> None:
    """Make an empty data directory (LPV_OED_DATA_DIR) of a backup, after it was found to be whole."""
    from app.backups import restore as run

    run(source)


def main() -> None:
    """The program lpv-oed; the matrices are small, and more threads would only wait for each other."""
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    application()


if __name__ == "__main__":
    main()
