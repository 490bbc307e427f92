"""The project's own source files, read once and parsed, for tests that look at the code."""

import ast
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("identification", "oed", "app")

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Source:
    """One Python file: its dotted module name, path from the top of the checkout, text and syntax tree."""

    module: str
    path: Path
    text: str
    tree: ast.Module

    @property
    def lines(self) -> int:
        return len(self.text.splitlines())

    def functions(self) -> Iterator[Function]:
        return (node for node in ast.walk(self.tree) if isinstance(node, Function))

    def imports(self, when_loaded: bool = False) -> Iterator[tuple[int, str]]:
        """Line and absolute dotted name of everything imported; `when_loaded`: not what only functions import."""
        for node in _outside_functions(self.tree) if when_loaded else ast.walk(self.tree):
            if isinstance(node, ast.Import):
                yield from ((node.lineno, alias.name) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                yield from ((node.lineno, f"{self._base(node)}.{alias.name}") for alias in node.names)

    def _base(self, node: ast.ImportFrom) -> str:
        if not node.level:
            return node.module or ""
        parts = self.module.split(".")
        package = parts if self.path.name == "__init__.py" else parts[:-1]
        above = package[: len(package) - node.level + 1]
        return ".".join([*above, *([node.module] if node.module else [])])


def _outside_functions(node: ast.AST) -> Iterator[ast.AST]:
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, Function):
            yield child
            yield from _outside_functions(child)


def parse(module: str, path: Path, text: str) -> Source:
    """The source of a module; a test may give its own text."""
    return Source(module, path, text, ast.parse(text))


@cache
def sources(package: str) -> tuple[Source, ...]:
    """Every Python file of one of the packages."""
    found = []
    for path in sorted((ROOT / package).rglob("*.py")):
        relative = path.relative_to(ROOT)
        parts = relative.with_suffix("").parts
        module = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found.append(parse(module, relative, path.read_text(encoding="utf-8")))
    return tuple(found)


def all_sources() -> tuple[Source, ...]:
    return tuple(source for package in PACKAGES for source in sources(package))


@cache
def committed_files() -> tuple[Path, ...]:
    """Files under version control, or everything but the ignored folders where there is no git."""
    try:
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return tuple(p.relative_to(ROOT) for p in ROOT.rglob("*") if p.is_file() and ".venv" not in p.parts)
    return tuple(Path(name) for name in listed.split("\0") if name and (ROOT / name).is_file())
