"""What the repository promises a stranger: two commands, a check, a changelog, no pointer to a package server."""

import ast
import os
import re
import tomllib

from tests.support.sources import ROOT, Source, all_sources, committed_files

# Put together here, so that this file does not contain what it looks for.
REGISTRY_HOSTS = [
    ".".join(words) for words in (("pypi", "org"), ("pythonhosted", "org"), ("npmjs", "org"), ("crates", "io"))
]
DOWNLOAD = re.compile(
    r"https?://\S+\.(?:whl|tgz|tar\.gz|crate|jar|deb)\b|https?://\S+/simple\b|(?:extra-)?index-" + r"url\s*=?\s*http"
)
LOCK_FILES = {"poetry.lock", "pdm.lock", "uv.lock", "Pipfile.lock", "package-lock.json", "yarn.lock", "pylock.toml"}


def texts() -> list[tuple[str, str]]:
    found = []
    for path in committed_files():
        try:
            found.append((str(path), (ROOT / path).read_text(encoding="utf-8")))
        except UnicodeDecodeError:
            continue
    return found


def points_at_a_registry(text: str) -> bool:
    return bool(DOWNLOAD.search(text)) or any(host in text for host in REGISTRY_HOSTS)


def test_no_committed_file_points_at_a_package_server() -> None:
    assert [path for path, text in texts() if points_at_a_registry(text)] == []
    assert points_at_a_registry("https://" + "files.example.test/a/b.whl")
    assert points_at_a_registry("index-" + "url = https://example.test")


def test_there_is_no_lock_file_with_addresses() -> None:
    assert [path for path in committed_files() if path.name in LOCK_FILES] == []


def test_every_requirement_is_pinned_and_says_why() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    project = tomllib.loads(text)["project"]
    wanted = project["dependencies"] + project["optional-dependencies"]["dev"]
    names = {re.split(r"[<>=\[ ]", requirement)[0].lower() for requirement in wanted}
    pins = (ROOT / "constraints.txt").read_text(encoding="utf-8")
    assert {name for name in names if not re.search(rf"^{re.escape(name)}==", pins, re.MULTILINE)} == set()
    assert [w for w in wanted if not re.search(rf'^ *"{re.escape(w)}", +# \S', text, re.MULTILINE)] == []


def test_the_readme_begins_with_the_two_commands() -> None:
    lines = [line.strip() for line in (ROOT / "README.md").read_text(encoding="utf-8").splitlines() if line.strip()]
    assert "make demo" in lines[:8]
    assert "make test" in lines[:8]


def test_the_changelog_speaks_of_this_version() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    headings = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert any(version in heading for heading in headings), headings


def test_the_check_can_be_run() -> None:
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


def test_decisions_are_numbered_one_page_each() -> None:
    decisions = sorted((ROOT / "docs" / "adr").glob("*.md"))
    assert [d.name[:4] for d in decisions] == [f"{n:04}" for n in range(1, len(decisions) + 1)]
    assert decisions
    assert [d.name for d in decisions if len(d.read_text(encoding="utf-8").split()) > 600] == []


def pickles_or_prints(source: Source) -> list[str]:
    prints = [n.lineno for n in ast.walk(source.tree) if isinstance(n, ast.Call) and ast.unparse(n.func) == "print"]
    pickles = [
        line
        for line, name in source.imports()
        if name.split(".")[0] in {"pickle", "cloudpickle", "dill", "joblib", "shelve"}
    ]
    unsafe = [
        n.lineno
        for n in ast.walk(source.tree)
        if isinstance(n, ast.keyword) and n.arg == "allow_pickle" and ast.unparse(n.value) != "False"
    ]
    return [f"{source.path}:{line}" for line in sorted(prints + pickles + unsafe)]


def test_the_packages_neither_print_nor_pickle() -> None:
    assert [line for source in all_sources() for line in pickles_or_prints(source)] == []
