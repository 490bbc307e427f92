"""The scripts of the pages: small rooms, no markup in strings, nothing that the content security policy refuses."""

import re
from pathlib import Path
from statistics import median

from tests.support.sources import ROOT

STATIC = ROOT / "app" / "static"
# Markup from strings, code from strings, and other servers.
REFUSED = re.compile(
    r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|https?://(?!www\.w3\.org/)"
)
IMPORT = re.compile(r'^(?:import|export) .*?from "([^"]+)";|^import "([^"]+)";|import\("([^"]+)"\)', re.MULTILINE)


def scripts() -> dict[Path, str]:
    return {path: path.read_text(encoding="utf-8") for path in sorted(STATIC.rglob("*.js"))}


def test_scripts_are_small() -> None:
    lengths = {path: text.count("\n") for path, text in scripts().items()}
    assert lengths
    assert median(lengths.values()) <= 150
    assert {path: length for path, length in lengths.items() if length > 250} == {}


def test_every_script_says_what_it_is_for() -> None:
    assert [path for path, text in scripts().items() if not text.startswith("// ")] == []


def test_scripts_hold_nothing_that_is_refused() -> None:
    assert [f"{path}: {found[0]}" for path, text in scripts().items() if (found := REFUSED.search(text))] == []
    assert REFUSED.search("place.innerHTML = text")
    assert REFUSED.search('fetch("https://elsewhere.example")')


def test_imports_lead_to_scripts_that_are_there() -> None:
    targets = [(path, next(filter(None, found))) for path, text in scripts().items() for found in IMPORT.findall(text)]
    assert len(targets) > 50
    assert [(path, to) for path, to in targets if not (path.parent / to).is_file()] == []


def test_scripts_are_used() -> None:
    used = {
        (path.parent / next(filter(None, found))).resolve()
        for path, text in scripts().items()
        for found in IMPORT.findall(text)
    }
    shells = "".join(path.read_text() for path in (ROOT / "app" / "pages" / "templates").glob("*.j2"))
    named = {STATIC / address for address in re.findall(r"\{\{ static \}\}/([\w/]+\.js)", shells)}
    assert set(scripts()) - used - named == set()
