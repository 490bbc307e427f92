"""The table of what works for which structure, as it stands in README."""

from collections.abc import Mapping
from pathlib import Path

from tests.support.api import Api
from tests.support.loop_plants import PLANTS
from tests.support.loop_walk import STEPS, Walk

README = Path(__file__).parents[2] / "README.md"
BEGIN, END = "<!-- structures and steps: begin -->\n", "<!-- structures and steps: end -->\n"
Cells = Mapping[tuple[bool, str], str]


def walked(api: Api) -> str:
    """The table with its reasons, after walking every cell."""
    return table({one.name: Walk(api, one).walked() for one in PLANTS})


def table(found: Mapping[str, Cells]) -> str:
    """One row a structure, without and with an effect in the model; what does not work has a number and its reason."""
    reasons: dict[str, int] = {}
    rows = [["structure", *STEPS], ["---"] * (1 + len(STEPS))]
    for name, cells in found.items():
        for grown in (False, True):
            words = [_cell(cells[grown, step], reasons) for step in STEPS]
            rows.append([f"{name}, with an effect" if grown else name, *words])
    lines = [f"| {' | '.join(row)} |" for row in rows]
    told = [f"{number}. {reason[0].upper()}{reason[1:]}." for reason, number in reasons.items()]
    return "\n".join([*lines, "", *told]) + "\n"


def _cell(reason: str, reasons: dict[str, int]) -> str:
    return f"({reasons.setdefault(reason, len(reasons) + 1)})" if reason else "yes"


def kept() -> str:
    """The table in README."""
    return README.read_text(encoding="utf-8").split(BEGIN)[1].split(END)[0].strip() + "\n"


def keep(text: str) -> None:
    """Write it into README."""
    before, rest = README.read_text(encoding="utf-8").split(BEGIN)
    README.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}", encoding="utf-8")
