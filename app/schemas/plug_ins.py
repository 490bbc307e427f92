"""Schemas made from plug-ins: what a file of identification or oed offers is offered over HTTP as well."""

import dataclasses
import operator
import types
import typing
from collections.abc import Iterable, Mapping
from functools import cached_property, reduce
from types import ModuleType
from typing import Any, Literal

import numpy as np
from pydantic import Field, create_model, model_validator
from typing_extensions import TypeAliasType

from app.schemas.common import CamelModel, Double, Integer
from identification.registry import discover

_LIST: Any = list
_LITERAL: Any = Literal


class PlugInDocument(CamelModel):
    """A plug-in by its `kind`, with its options."""

    def build(self) -> Any:
        """The plug-in itself."""
        raise NotImplementedError


@dataclasses.dataclass(frozen=True)
class PlugInFamily:
    """All plug-ins of a package, as one named union that is told apart by `kind`."""

    name: str
    suffix: str
    package: ModuleType

    @cached_property
    def models(self) -> Mapping[str, type[PlugInDocument]]:
        """The schema of each plug-in by its kind."""
        return {kind: _schema(plug_in, self.suffix) for kind, plug_in in discover(self.package).items()}

    @cached_property
    def union(self) -> Any:
        """The type to annotate a field with."""
        return named_union(self.name, self.models.values(), "kind")


def named_union(name: str, members: Iterable[type[Any]], discriminator: str) -> Any:
    """A union with a name of its own in the OpenAPI document; one member needs no discriminator."""
    every = tuple(members)
    alias: Any = TypeAliasType
    if len(every) == 1:
        return alias(name, every[0])
    return alias(name, typing.Annotated[_union(every), Field(discriminator=discriminator)])


def _union(members: Iterable[Any]) -> Any:
    return reduce(operator.or_, members)


def _schema(plug_in: type[Any], suffix: str) -> type[PlugInDocument]:
    def build(self: PlugInDocument) -> Any:
        return plug_in(**{f.name: _frozen(getattr(self, f.name)) for f in dataclasses.fields(plug_in)})

    def buildable(self: PlugInDocument) -> PlugInDocument:
        build(self)
        return self

    hints = typing.get_type_hints(plug_in, include_extras=True)
    options = {f.name: _option(f, hints[f.name]) for f in dataclasses.fields(plug_in)}
    name = plug_in.__name__ if plug_in.__name__.endswith(suffix) else plug_in.__name__ + suffix
    make: Any = create_model
    model: type[PlugInDocument] = make(
        name,
        __base__=PlugInDocument,
        __doc__=summary(plug_in),
        __module__=plug_in.__module__,
        __validators__={"buildable": model_validator(mode="after")(buildable)},
        kind=(_LITERAL[plug_in.kind], Field(description="which one")),
        **options,
    )
    model.build = build  # type: ignore[method-assign]
    return model


def summary(plug_in: type[Any]) -> str:
    """The first paragraph of a docstring, as one line."""
    return " ".join((plug_in.__doc__ or "").split("\n\n")[0].split())


def _option(field: "dataclasses.Field[Any]", hint: Any) -> tuple[Any, Any]:
    description, hint = _described(hint)
    if field.default is not dataclasses.MISSING:
        return _json_type(hint), Field(default=_thawed(field.default), description=description)
    if field.default_factory is not dataclasses.MISSING:
        default = field.default_factory
        return _json_type(hint), Field(default_factory=lambda: _thawed(default()), description=description)
    return _json_type(hint), Field(description=description)


def _described(hint: Any) -> tuple[str, Any]:
    if typing.get_origin(hint) is typing.Annotated:
        inner, *notes = typing.get_args(hint)
        return next((note for note in notes if isinstance(note, str)), ""), inner
    return "", hint


def _json_type(hint: Any) -> Any:
    """The type of a document field for the type of an option: sequences become lists, numbers finite."""
    hint = _described(hint)[1]
    if hint in (int, float):
        return Integer if hint is int else Double
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return _union(map(_json_type, arguments))
    if origin in (tuple, list) or hint is np.ndarray:
        inner = _LIST[_json_type(arguments[0])]
        if origin is tuple and arguments[-1] is not Ellipsis:
            return typing.Annotated[inner, Field(min_length=len(arguments), max_length=len(arguments))]
        return inner
    return hint


def _frozen(value: Any) -> Any:
    return tuple(_frozen(item) for item in value) if isinstance(value, list) else value


def _thawed(value: Any) -> Any:
    return [_thawed(item) for item in value] if isinstance(value, tuple) else value
