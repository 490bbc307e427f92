"""The catalogue: what discovery found, with the schemas of its options."""

import json
from functools import cache
from typing import Any, Literal

import identification.methods
from app import __version__
from app.schemas.catalogue import (
    Catalogue,
    CatalogueEntry,
    CatalogueOption,
    EffectEntry,
    EffectParameterEntry,
    MethodEntry,
)
from app.schemas.experiments import ExperimentKind
from app.schemas.families import FAMILIES
from app.schemas.plug_ins import PlugInDocument, summary
from identification.effects.library import library
from identification.methods.method import Data, Method
from identification.models.physical import PhysicalForm
from identification.models.rational import RationalStructure
from identification.models.state_space import StateSpaceStructure
from identification.models.structure import Structure
from identification.places.place import Effect
from identification.registry import discover
from identification.signals import TimeRecord
from identification.varying.records import VaryingRecord

SIGNS: dict[int, Literal["any", "positive", "negative"]] = {0: "any", 1: "positive", -1: "negative"}


@cache
def catalogue() -> Catalogue:
    """Everything that requests can choose from."""
    entries = {
        family: [_entry(kind, model) for kind, model in found.models.items()] for family, found in FAMILIES.items()
    }
    effects = [_effect(one) for one in library()]
    ways = [_method(one).as_json() for one in discover(identification.methods).values()]
    return Catalogue.model_validate({"softwareVersion": __version__, "methods": ways, **entries, "effects": effects})


def _method(method: type[Method]) -> MethodEntry:
    takes = method.takes
    along, rational = VaryingRecord in takes.data, RationalStructure in takes.structures
    return MethodEntry(
        kind=method.kind,
        description=summary(method),
        request_kind="varyingScheduling" if along else "rational" if rational else "stateSpace",
        experiments=[kind for one in takes.data for kind in _experiments(one, rational)],
        structures=[domain for one in takes.structures for domain in _time_domains(one, along)],
        takes_prior=takes.prior,
    )


def _experiments(data: type[Data], rational: bool) -> list[ExperimentKind]:
    """The kinds of documents of data; a rational structure has one input and output."""
    if data is VaryingRecord:
        return ["varyingRecord"]
    if data is TimeRecord:
        return ["timeRecord"]
    return ["frequencyResponse"] if rational else ["frequencyResponse", "matrixFrequencyResponse"]


def _time_domains(structure: type[Structure], along: bool) -> list[str]:
    """The discriminators of the documents of a structure; along p(t) only discrete time is identified."""
    if issubclass(structure, StateSpaceStructure):
        return ["discreteStateSpace"] if along else ["discreteStateSpace", "continuousStateSpace"]
    return ["continuousPhysical"] if issubclass(structure, PhysicalForm) else ["discrete", "continuous"]


def _effect(effect: Effect) -> EffectEntry:
    return EffectEntry.model_validate(
        {
            "kind": effect.kind,
            "title": effect.title,
            "description": summary(type(effect)),
            "domain": effect.domain,
            "place": effect.place,
            "unit": effect.unit,
            "sign": SIGNS[effect.sign],
            "largestAmplitude": effect.largest,
            "needsRecords": effect.needs_records,
            "amplitudes": effect.shapes,
            "parameters": [
                EffectParameterEntry(name=one.name, quantity=one.quantity, fitted=one.fitted)
                for one in effect.parameters
            ],
            "source": effect.source,
        }
    )


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
