"""What is missing in campaigns of others: python -m benchmarks.cases FOLDER --output RESULTS.json --only NAME NAME.

FOLDER holds index.json, a list of cases with what a user would say of each (quantities, units, hold, feedback,
structure, start, experiments), and NAME.npz with the arrays of each: `fittedI_u` and `fittedI_y`, or `fittedI_omega`,
`fittedI_response` and `fittedI_variance`, and of the held-out experiments the inputs or frequencies. Writes one entry
a case (verdict, announced kinds, what was added with its amplitude) beside an npz of the predictions for the held-out
experiments without and with what was added. A case that cannot be judged says why; none ends the run.
"""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.cases.answering import Answer, answer, not_judged
from benchmarks.cases.reading import read, stated
from benchmarks.command import command_line, print_table, write_json


def answered(entry: dict[str, Any], folder: Path, seed: int = 0) -> Answer:
    """The answer to one entry of the index, whatever happens."""
    try:
        return answer(read(entry, folder), seed)
    except Exception as error:  # a case is judged or says why not
        return not_judged(entry["case"], error)


def results(folder: Path, output: Path | None, only: list[str], seed: int = 0) -> list[dict[str, Any]]:
    """Answers to all cases, written after each, so that what is done stays when a run is ended."""
    found: list[dict[str, Any]] = []
    for entry in stated(folder, only):
        one = answered(entry, folder, seed)
        found.append(one.said | {"predictions": _saved(one, output)})
        write_json(found, output)
    return found


def _saved(one: Answer, output: Path | None) -> str | None:
    if output is None or not one.predictions:
        return None
    file = output.with_name(f"{output.stem}_{one.said['case']}.npz")
    arrays: dict[str, Any] = one.predictions
    np.savez_compressed(file, **arrays)
    return file.name


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__)
    parser.add_argument("folder", type=Path, help="where index.json and the arrays are")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these cases alone")
    options = parser.parse_args()
    if options.output is not None:
        options.output.parent.mkdir(parents=True, exist_ok=True)
    found = results(options.folder, options.output, options.only)
    shown = ("case", "verdict", "announced", "confident", "seconds", "reason")
    print_table([{name: one.get(name) for name in shown} for one in found])


if __name__ == "__main__":
    main()
