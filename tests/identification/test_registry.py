"""Discovery of plug-ins."""

import sys
from types import ModuleType

import pytest

import identification.bases
from identification.registry import discover


def package_of(tmp_path, monkeypatch, name, **modules) -> ModuleType:
    folder = tmp_path / name
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    for module, text in modules.items():
        (folder / f"{module}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    for loaded in [key for key in sys.modules if key.split(".")[0] == name]:
        monkeypatch.delitem(sys.modules, loaded)
    return __import__(name)


def test_what_is_found_is_fixed():
    found = discover(identification.bases)
    assert list(found) == ["b_spline", "chebyshev", "polynomial"]
    with pytest.raises(TypeError):
        found["polynomial"] = object  # type: ignore[index]


def test_imported_classes_and_helpers_are_not_plug_ins(tmp_path, monkeypatch):
    package = package_of(
        tmp_path,
        monkeypatch,
        "found_once",
        one="class One:\n    kind = 'one'\n",
        two="from found_once.one import One\nclass Helper:\n    pass\nclass Abstract:\n    kind: str\n",
    )
    assert list(discover(package)) == ["one"]


def test_duplicates_are_refused(tmp_path, monkeypatch):
    package = package_of(
        tmp_path, monkeypatch, "found_twice", one="class One:\n    kind = 'x'\n", two="class Two:\n    kind = 'x'\n"
    )
    with pytest.raises(ValueError, match="claimed by both"):
        discover(package)
