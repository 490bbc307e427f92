"""What the unification is to end may only fall: each number is lowered by the commit that lowers it."""

import ast
import re
from collections.abc import Callable

import pytest

from tests.support.sources import PACKAGES, Source, all_sources, parse, sources

KINDS = re.compile(r"Structure$|StateSpace$|^VaryingRecord|^RATIONAL$")
QUESTIONS = {"is_state_space", "rational_of"}
PARTS_OF_A_KIND = {"state_space", "varying"}
MODELS = re.compile(r"(Model|StateSpace|Estimate)$")


def _names(node: ast.expr) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}


def questions_of_kind(source: Source) -> list[str]:
    """Calls that ask what a model or structure is, instead of asking it to answer."""
    found = []
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            asked = node.func.id == "isinstance" and any(KINDS.search(name) for name in _names(node.args[1]))
            if asked or node.func.id in QUESTIONS:
                found.append(f"{source.path}:{node.lineno}")
        elif isinstance(node, ast.Attribute) and node.attr in PARTS_OF_A_KIND and isinstance(node.ctx, ast.Load):
            found.append(f"{source.path}:{node.lineno}")
    return found


def definitions(name: str) -> Callable[[Source], list[str]]:
    return lambda source: [f"{source.path}:{f.lineno}" for f in source.functions() if f.name == name]


def classes_of_models(source: Source) -> list[str]:
    """Models and estimates of the numeric package."""
    if not source.module.startswith("identification."):
        return []
    classes = (node for node in ast.walk(source.tree) if isinstance(node, ast.ClassDef))
    return [f"{source.path}:{node.lineno} {node.name}" for node in classes if MODELS.search(node.name)]


COUNTED: dict[str, tuple[Callable[[Source], list[str]], int]] = {
    "tests of kind": (questions_of_kind, 56),
    "frequency_response": (definitions("frequency_response"), 3),
    "response_covariance": (definitions("response_covariance"), 1),
    "classes of models": (classes_of_models, 8),
}
LOOSE_MODULES = 12


@pytest.mark.parametrize("what", COUNTED)
def test_may_only_fall(what: str) -> None:
    count, most = COUNTED[what]
    found = [line for source in all_sources() for line in count(source)]
    assert len(found) == most, "\n".join(["write the lower number here, or do without the new one:", *found])


def test_modules_at_the_root_of_identification_may_only_fall() -> None:
    loose = [s.module for s in sources("identification") if s.module.count(".") == 1 and s.path.name != "__init__.py"]
    assert len(loose) == LOOSE_MODULES, loose


def test_what_is_counted_is_seen() -> None:
    text = "def f(m):\n    if isinstance(m, A | FrozenStructure) or is_state_space(m):\n        x = m.varying\n"
    assert len(questions_of_kind(parse("app.bad", sources(PACKAGES[2])[0].path, text))) == 3
    assert definitions("f")(parse("oed.bad", sources("oed")[0].path, text))
    assert classes_of_models(parse("identification.bad", sources("oed")[0].path, "class OtherModel:\n    pass\n"))
