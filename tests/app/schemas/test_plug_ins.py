"""One new file of identification or oed is in the schemas and in the catalogue, with nothing else changed."""

import sys
from pathlib import Path
from types import ModuleType

import pytest
from fastapi.testclient import TestClient
from pydantic import BaseModel, ValidationError, create_model

from app.schemas.families import BASES, FAMILIES, LOCAL_ESTIMATORS, TARGETS
from app.schemas.plug_ins import PlugInFamily
from identification.registry import discover

PLUG_IN = '''
"""Sines of the scheduling variable."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from identification.errors import RangeError


@dataclass(frozen=True)
class Fourier:
    """Sines and cosines of the scheduling variable
    over its range.

    More about them.
    """

    kind: ClassVar[str] = "fourier"

    order: Annotated[int, "highest harmonic"]
    phases: Annotated[tuple[float, ...], "phase of each, rad"] = (0.0,)
    pair: tuple[float, float] | None = None
    mode: Literal["sine", "cosine"] = "sine"
    wanted: tuple[float | None, ...] = ()

    def __post_init__(self) -> None:
        if self.order < 1:
            raise RangeError("the order must be one or more", "order")
'''


@pytest.fixture
def family(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> PlugInFamily:
    """A package with one file in it."""
    folder = tmp_path / "waves_for_test"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "fourier.py").write_text(PLUG_IN)
    monkeypatch.syspath_prepend(str(tmp_path))
    package = __import__("waves_for_test")
    yield PlugInFamily("Wave", "Basis", package)
    for name in [name for name in sys.modules if name.startswith("waves_for_test")]:
        del sys.modules[name]


def test_a_file_becomes_a_schema(family: PlugInFamily) -> None:
    schema = family.models["fourier"].model_json_schema()
    assert schema["title"] == "FourierBasis"
    assert schema["description"] == "Sines and cosines of the scheduling variable over its range."
    assert schema["required"] == ["kind", "order"]
    assert schema["properties"]["order"]["description"] == "highest harmonic"
    assert schema["properties"]["order"]["type"] == "integer"
    assert schema["properties"]["phases"]["default"] == [0.0]
    assert schema["properties"]["mode"]["enum"] == ["sine", "cosine"]
    assert schema["properties"]["kind"]["const"] == "fourier"


def test_a_document_becomes_the_plug_in(family: PlugInFamily) -> None:
    document = {"kind": "fourier", "order": 2, "phases": [0.5, 1], "pair": [1.0, 2.0], "wanted": [None, 3.0]}
    built = family.models["fourier"].model_validate(document).build()
    assert (built.order, built.phases, built.pair, built.mode) == (2, (0.5, 1.0), (1.0, 2.0), "sine")
    assert built.wanted == (None, 3.0)
    hash(built)


@pytest.mark.parametrize(
    "change",
    [
        {"order": "2"},
        {"order": 0},
        {"order": 1.5},
        {"phases": [float("nan")]},
        {"pair": [1.0]},
        {"mode": "tangent"},
        {"colour": 1},
        {"kind": "other"},
    ],
)
def test_bad_documents_are_refused(family: PlugInFamily, change: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        family.models["fourier"].model_validate({"kind": "fourier", "order": 2, **change})


def test_unions_of_several_are_told_apart_by_kind() -> None:
    Holder: type[BaseModel] = create_model("Holder", basis=(BASES.union, ...))
    assert Holder.model_validate({"basis": {"kind": "chebyshev", "degree": 2}}).basis.build().size == 3
    schema = Holder.model_json_schema()["$defs"]["Basis"]
    assert schema["discriminator"]["propertyName"] == "kind"
    with pytest.raises(ValidationError, match="fourier"):
        Holder.model_validate({"basis": {"kind": "fourier", "order": 2}})


@pytest.mark.parametrize("name", FAMILIES)
def test_every_plug_in_is_in_the_catalogue_and_in_the_document(name: str, client: TestClient) -> None:
    family = FAMILIES[name]
    kinds = set(discover(family.package))
    assert {entry["kind"] for entry in client.get("/v1/catalogue").json()[name]} == kinds
    schemas = client.get("/v1/openapi.json").json()["components"]["schemas"]
    assert {schema.model_json_schema()["title"] for schema in family.models.values()} <= set(schemas)
    assert len(family.models) == len(kinds) > 0
    if len(kinds) > 1:
        assert set(schemas[family.name]["discriminator"]["mapping"]) == kinds


def test_the_catalogue_names_options_with_units(client: TestClient) -> None:
    targets = {entry["kind"]: entry for entry in client.get("/v1/catalogue").json()["targets"]}
    options = {option["name"]: option for option in targets["response_deviation"]["options"]}
    assert "rad/s" in options["minimumRadPerSecond"]["description"]
    assert options["minimumRadPerSecond"]["required"]
    assert not options["relative"]["required"]
    assert options["relative"]["valueSchema"] == {"default": True, "type": "boolean"}
    assert all(entry["description"] for entry in targets.values())


def test_options_that_the_plug_in_refuses_are_refused_in_documents() -> None:
    with pytest.raises(ValidationError, match="degree"):
        BASES.models["polynomial"].model_validate({"kind": "polynomial", "degree": -1})
    assert isinstance(LOCAL_ESTIMATORS.package, ModuleType)
    assert TARGETS.models["parameter_deviation"].model_validate(
        {"kind": "parameter_deviation", "standardDeviations": [None, 0.1]}
    ).build().standard_deviations == (None, 0.1)
