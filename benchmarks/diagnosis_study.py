"""How well the diagnosis does on the virtual bench.

python -m benchmarks.diagnosis_study {hits,alarms,pairs,unknown} [--runs 50] [--noise 0.03] [--output FILE.json]
    [--page FILE.html] [--workers 2] [--from FILE.json …]

alarms: nothing hidden; hits: one effect hidden at a time; pairs: two; unknown: an effect taken out of the library.
Prints the figures, writes every run as JSON, and pictures with their tables as one page that needs no network.
--from draws again what was measured before.
"""

import json
from pathlib import Path
from types import ModuleType
from typing import Any

from app.report.page import write
from benchmarks.command import command_line, write_json
from benchmarks.processes import over
from benchmarks.virtual_bench import alarms, hits, pairs, pictures, unknown
from benchmarks.virtual_bench.study import strengths

STUDIES: dict[str, ModuleType] = {"hits": hits, "alarms": alarms, "pairs": pairs, "unknown": unknown}


def work(task: tuple[str, Any]) -> dict[str, Any]:
    """One run of a study."""
    study, own = task
    found: dict[str, Any] = STUDIES[study].one(own)
    return found


def tasks(study: str, runs: int, noise: list[float] | None) -> list[tuple[str, Any]]:
    """What the runs of a study are."""
    found = hits.tasks(runs, tuple(noise)) if study == "hits" and noise else STUDIES[study].tasks(runs)
    return [(study, one) for one in found]


def main() -> None:
    """Parses the command line, runs, prints, writes."""
    parser = command_line(__doc__ or "", runs=2, page=True)
    parser.add_argument("study", choices=sorted(STUDIES))
    parser.add_argument("--noise", type=float, nargs="+", choices=hits.SHARES, help="noise levels of the hits")
    parser.add_argument("--workers", type=int, default=2, help="processes; the figures do not depend on it")
    parser.add_argument("--from", type=Path, nargs="+", dest="measured", default=[], help="JSON of runs made before")
    options = parser.parse_args()
    strengths()
    runs = [run for path in options.measured for run in json.loads(path.read_text())["runs"]]
    if not runs:
        runs = over(work, tasks(options.study, options.runs, options.noise), options.workers)
    summary = STUDIES[options.study].summary(runs)
    print(json.dumps(summary, indent=1, ensure_ascii=False))
    write_json({"summary": summary, "runs": runs}, options.output)
    if options.page:
        write(pictures.PAGES[options.study](runs, summary), options.page)


if __name__ == "__main__":
    main()
