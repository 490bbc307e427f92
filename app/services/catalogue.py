"""The catalogue: what discovery found, with the schemas of its options."""

import json
from typing import Any

from app import __version__
from app.schemas.catalogue import Catalogue, CatalogueEntry, CatalogueOption
from app.schemas.families import FAMILIES
from app.schemas.plug_ins import PlugInDocument


def catalogue() -> Catalogue:
    """Everything that requests can choose from."""
    entries = {
        family: [_entry(kind, model) for kind, model in found.models.items()] for family, found in FAMILIES.items()
    }
    return Catalogue.model_validate({"softwareVersion": __version__, **entries})


def _entry(kind: str, model: type[PlugInDocument]) -> CatalogueEntry:
    schema = model.model_json_schema(by_alias=True)
    required = schema.get("required", [])
    options = [
        CatalogueOption(
            name=name,
            description=value.get("description", ""),
            required=name in required,
            value_schema=_self_contained(value, schema.get("$defs", {})),
        )
        for name, value in schema["properties"].items()
        if name != "kind"
    ]
    return CatalogueEntry(kind=kind, description=schema.get("description", ""), options=options)


def _self_contained(value: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    """The schema of an option, with the definitions that it refers to."""
    own = {key: part for key, part in value.items() if key not in ("description", "title")}
    return {**own, "$defs": definitions} if "$ref" in json.dumps(own) else own
