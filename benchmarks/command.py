"""What the studies share on the command line: options, times, tables, files."""

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from time import perf_counter


def command_line(
    purpose: str, runs: int | None = None, seed: int | None = None, page: bool = False
) -> argparse.ArgumentParser:
    """A parser with --output, with --runs, --seed and --workers where there are defaults, and with --page."""
    parser = argparse.ArgumentParser(description=purpose, formatter_class=argparse.RawDescriptionHelpFormatter)
    if runs is not None:
        parser.add_argument("--runs", type=int, default=runs, help="how often it is repeated (default %(default)s)")
    if seed is not None:
        parser.add_argument("--seed", type=int, default=seed, help="the same seed, the same figures")
        parser.add_argument("--workers", type=int, default=2, help="processes; the figures do not depend on it")
    if page:
        parser.add_argument("--page", type=Path, help="where to write the pictures as an offline HTML page")
    parser.add_argument("--output", type=Path, help="where to write the figures as JSON")
    return parser


def timed(call: Callable[[], object], clock: Callable[[], float] = perf_counter) -> float:
    """Seconds of one call, of the wall clock or of another one."""
    start = clock()
    call()
    return clock() - start


def write_json(document: object, file: Path | None) -> None:
    """Writes a document of numbers (no NaN) and texts, when there is a file for it."""
    if file is not None:
        text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False, default=float)
        file.write_text(text + "\n", encoding="utf-8")


def print_table(rows: Sequence[Mapping[str, object]]) -> None:
    """Prints rows under the names of their cells, texts to the left and numbers to the right."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    cells = [names, *([shown(row.get(name)) for name in names] for row in rows)]
    texts = [any(isinstance(row.get(name), str) for row in rows) for name in names]
    widths = [max(len(line[i]) for line in cells) for i in range(len(names))]
    for line in cells:
        aligned = (f"{c:<{w}}" if text else f"{c:>{w}}" for c, w, text in zip(line, widths, texts, strict=True))
        print("  ".join(aligned).rstrip())


def shown(value: object) -> str:
    """A cell: numbers with six digits, nothing for nothing."""
    if value is None:
        return ""
    if isinstance(value, list | tuple):
        return ", ".join(shown(each) for each in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)
