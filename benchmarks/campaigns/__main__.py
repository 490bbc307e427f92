"""Twenty seeds of each kind, made, answered and judged: python -m benchmarks.campaigns FOLDER --runs 20 --only KIND.

FOLDER gets the campaigns as `benchmarks.cases` reads them, the truth beside them, and RESULTS.json. Every campaign has
other parameters: plants, sensors, noise, sample times, sizes of what is hidden. Prints by kind how many are right,
honest, wrong, wrong with confidence, and worse on what was held out, and the median and longest time.
"""

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.campaigns.campaign import write
from benchmarks.campaigns.judging import HARMLESS, held_out_errors, judged
from benchmarks.campaigns.kinds import kinds
from benchmarks.cases.__main__ import results
from benchmarks.command import command_line, print_table, write_json


def one(name: str, folder: Path, seed: int) -> dict[str, Any]:
    """A campaign of a kind made, answered and judged in a folder of its own."""
    case = f"{name}_{seed}"
    place = folder / case
    made = kinds()[name](case, np.random.default_rng([seed, *name.encode()]))
    write(place, [made])
    said = results(place, place / "RESULTS.json", [])[0]
    before, after = held_out_errors(said, place / "RESULTS.json", place / "answers")
    worse = before is not None and after is not None and after > HARMLESS * before
    truth = {k: v for k, v in vars(made.truth).items() if v}
    shown = {k: said.get(k) for k in ("verdict", "announced", "confident", "added", "seconds", "reason")}
    return {
        "kind": name,
        "case": case,
        "judged": judged(said, truth),
        "worse": worse,
        "before": before,
        "after": after,
    } | shown


def table(found: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The counts by kind, and over all."""
    names = list(dict.fromkeys(each["kind"] for each in found))
    return [_counted(name, [each for each in found if each["kind"] == name]) for name in names] + [
        _counted("all", found)
    ]


def _counted(name: str, found: list[dict[str, Any]]) -> dict[str, Any]:
    counts = Counter(each["judged"] for each in found)
    seconds = [each["seconds"] or 0.0 for each in found]
    words = ("right", "honest", "wrong", "confidently wrong")
    others = Counter(each["announced"][0] for each in found if each["judged"].endswith("wrong") and each["announced"])
    return (
        {"kind": name, "runs": len(found)}
        | {word: counts[word] for word in words}
        | {
            "worse": sum(each["worse"] for each in found),
            "median s": float(np.median(seconds)),
            "longest s": max(seconds),
            "named instead": ", ".join(f"{kind} {count}" for kind, count in others.most_common(3)),
        }
    )


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__ or "", runs=20, seed=1)
    parser.add_argument("folder", type=Path, help="where the campaigns are written")
    parser.add_argument("--only", nargs="+", default=list(kinds()), choices=list(kinds()), metavar="KIND")
    options = parser.parse_args()
    found: list[dict[str, Any]] = []
    tasks = [(name, options.seed + i) for i in range(options.runs) for name in options.only]
    with ProcessPoolExecutor(options.workers) as pool:
        futures = [pool.submit(partial(one, folder=options.folder), name=name, seed=seed) for name, seed in tasks]
        for future in futures:
            found.append(future.result())
            last = found[-1]
            worse, said = "worse " if last["worse"] else "", ", ".join(last["announced"] or ["-"])
            print(f"{last['judged']:18}{worse:6}{last['case']:30}{last['verdict']}: {said}", flush=True)
            write_json({"table": table(found), "campaigns": found}, options.output)
    print_table(table(found))


if __name__ == "__main__":
    main()
