"""Every figure and table of the five papers beside ours: python -m benchmarks.papers --runs 20 --only Ghosh2018.

Runs the studies behind them and writes docs/papers.md with its pictures. `--runs`: of the studies by chance; the papers
have 500 (Ghosh), 1000 (Goos) and 100 (Cox), which take hours. Ends with an error when a number that the paper's own
data determine is further than 1 % from what it prints.
"""

import sys
from pathlib import Path

from benchmarks.command import command_line
from benchmarks.papers import ghosh, others
from benchmarks.papers.gallery import Paper, write

PAGE = Path(__file__).resolve().parents[2] / "docs" / "papers.md"
TOLERANCE = 0.01
INTRO = """# The papers beside the software

Written by `make papers`. *Printed* is what the paper says, *ours* what the command below each part finds now, *off* the
difference where the paper's own data determine the number; where a system, a noise level or draws are not printed, none
is told. References are in `docs/references.bib`.

Not there yet: the process noise and the transients of [Goos2014] and its Figures 1 to 3; Lemma 1, pre-whitening and
Figure 1 of [Cox2018]; Remarks 2 and 3 and delays as part of a model of [Kergus2019]; the comparators Liu and
Juang–Suzuki of [Akcay2008].
"""


def wrong(papers: list[Paper]) -> list[str]:
    """The numbers that are further off than a per cent."""
    cells = [(paper.key, cell) for paper in papers for part in paper.parts for cell in part.cells]
    return [f"{key}: {cell.what}" for key, cell in cells if cell.off is not None and abs(cell.off) > TOLERANCE]


def main() -> int:
    """Parses the command line, runs, writes."""
    parser = command_line(__doc__ or "", runs=20)
    parser.add_argument(
        "--only", nargs="+", metavar="KEY", help="papers by their key; nothing is written but to --page"
    )
    parser.add_argument("--page", type=Path, help="where to write; default: docs/papers.md, all papers")
    options = parser.parse_args()
    makers = {
        "Ghosh2018": lambda: ghosh.paper(options.runs),
        "Kergus2019": lambda: others.kergus(options.runs),
        "Akcay2008": others.mckelvey,
        "Goos2014": lambda: others.goos(options.runs),
        "Cox2018": lambda: others.cox(options.runs),
    }
    papers = [makers[key]() for key in options.only or makers]
    page = options.page or (None if options.only else PAGE)
    if page is not None:
        write(papers, page, INTRO)
    off = wrong(papers)
    print("\n".join(off) if off else "every number that a paper's data determine is within 1 %")
    return int(bool(off))


if __name__ == "__main__":
    sys.exit(main())
