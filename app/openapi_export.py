"""Writes openapi/openapi.json from the code: `python -m app.openapi_export [--check]`."""

import argparse
import json
import sys
from pathlib import Path

from app.main import create_app
from app.settings import Settings

PUBLISHED = Path(__file__).resolve().parents[1] / "openapi" / "openapi.json"


def document() -> str:
    """The OpenAPI document as text: sorted keys, a newline at the end."""
    application = create_app(Settings(data_dir=Path("unused"), host="127.0.0.1"))
    return json.dumps(application.openapi(), indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def main(arguments: list[str] | None = None) -> int:
    """Write the file, or with --check only compare it; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="fail when the file is not what the code says")
    parser.add_argument("--output", type=Path, default=PUBLISHED)
    options = parser.parse_args(arguments)
    if not options.check:
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(document(), encoding="utf-8")
        return 0
    if options.output.exists() and options.output.read_text(encoding="utf-8") == document():
        return 0
    sys.stderr.write(f"{options.output} is not what the code says; run python -m app.openapi_export\n")
    return 1


if __name__ == "__main__":
    sys.exit(main())
