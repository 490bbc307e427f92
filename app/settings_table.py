"""The table of all settings, for docs/operations.md: python -m app.settings_table [--check]."""

import sys
from pathlib import Path
from typing import Any

from annotated_types import Ge, Gt, Le
from pydantic.fields import FieldInfo

from app.settings import Settings

PAGE = Path(__file__).resolve().parents[1] / "docs" / "operations.md"
BEGIN, END = "<!-- settings: begin -->\n", "<!-- settings: end -->\n"
WORDS = ((Ge, "ge", "≥"), (Gt, "gt", ">"), (Le, "le", "≤"))


def table() -> str:
    """One row a setting: its variable, default, bounds and meaning."""
    prefix = Settings.model_config["env_prefix"]
    rows = [_row(f"{prefix}{name}".upper(), field) for name, field in Settings.model_fields.items()]
    return "\n".join(["| variable | default | what it is |", "|---|---|---|", *rows]) + "\n"


def _row(variable: str, field: FieldInfo) -> str:
    bounds = ", ".join(
        f"{sign} {getattr(note, name)}"
        for note in field.metadata
        for kind, name, sign in WORDS
        if isinstance(note, kind)
    )
    default = "" if field.default is None else f"`{_shown(field.default)}`"
    return f"| `{variable}` | {default} | {field.description}{f' ({bounds})' if bounds else ''} |"


def _shown(default: Any) -> str:
    return str(list(default)).replace("'", '"') if isinstance(default, tuple) else str(default)


def page(text: str) -> str:
    """The page with the table of now."""
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return before + BEGIN + table() + END + after


def main(arguments: list[str]) -> int:
    """Write the table into the page, or say whether it is the one of now."""
    text = PAGE.read_text(encoding="utf-8")
    if "--check" in arguments:
        return int(text != page(text))
    PAGE.write_text(page(text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
