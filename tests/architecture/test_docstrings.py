"""Everything public in the numeric packages says what it is, and every source it cites is in docs/references.bib."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.sources import ROOT, Function, Source, all_sources, parse, sources

CITATION = re.compile(r"\[([A-Z][A-Za-z]+\d{4}[a-z]?)(?=[],;])|(?<=; )([A-Z][A-Za-z]+\d{4}[a-z]?)(?=[],;])")
ENTRY = re.compile(r"^@\w+\{([^,\s]+),", re.MULTILINE)


def public(body: list[ast.stmt], prefix: str) -> Iterator[tuple[str, ast.ClassDef | Function]]:
    """Public classes and functions, and the public methods of public classes."""
    for node in body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) and not node.name.startswith("_"):
            yield f"{prefix}{node.name}", node
            if isinstance(node, ast.ClassDef):
                yield from public(node.body, f"{prefix}{node.name}.")


def decorated(node: ast.ClassDef | Function, names: set[str]) -> bool:
    return any(ast.unparse(d).split("(")[0].split(".")[-1] in names for d in node.decorator_list)


def undocumented(source: Source) -> list[str]:
    """What lacks a docstring; overloads and plug-ins' overrides of documented methods need none of their own."""
    return [
        f"{source.path}:{node.lineno} {name}"
        for name, node in public(source.tree.body, "")
        if not ast.get_docstring(node) and not decorated(node, {"overload", "override"})
    ]


def known_sources() -> set[str]:
    return set(ENTRY.findall((ROOT / "docs" / "references.bib").read_text(encoding="utf-8")))


def citations(source: Source) -> set[str]:
    return {a or b for a, b in CITATION.findall(source.text)}


@pytest.mark.parametrize("package", ["identification", "oed"])
def test_everything_public_has_a_docstring(package: str) -> None:
    assert [line for source in sources(package) for line in undocumented(source)] == []


def test_every_module_says_what_it_is_for() -> None:
    assert [str(s.path) for s in all_sources() if s.lines and not ast.get_docstring(s.tree)] == []


def test_every_cited_source_is_listed() -> None:
    cited = {(str(source.path), key) for source in all_sources() for key in citations(source)}
    assert cited, "nothing is cited: does the pattern still fit?"
    assert {(path, key) for path, key in cited if key not in known_sources()} == set()


def test_a_missing_docstring_and_an_unknown_source_are_seen() -> None:
    text = '"""M, see [Nobody1999, (3)] and [Ghosh2018; Nobody2001]."""\nclass A:\n    """A."""\n    def f(self): ...\n'
    source = parse("oed.bad", Path("oed/bad.py"), text)
    assert undocumented(source) == ["oed/bad.py:4 A.f"]
    assert citations(source) == {"Nobody1999", "Ghosh2018", "Nobody2001"}


def test_every_entry_of_the_references_is_closed() -> None:
    text = (ROOT / "docs" / "references.bib").read_text(encoding="utf-8")
    entries = re.split(r"^(?=@)", text, flags=re.MULTILINE)
    assert [one[:40] for one in entries if one.count("{") != one.count("}")] == []
