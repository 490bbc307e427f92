"""Schemas made from plug-ins: what a file of identification or oed offers is offered over HTTP as well."""

import dataclasses
import operator
import types
import typing
from collections.abc import Callable, Iterable, Mapping
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

    def build(self, **given: Any) -> Any:
        """The plug-in itself; `given` are the options that are stated elsewhere, ignored where it has none of them."""
        raise NotImplementedError


@dataclasses.dataclass(frozen=True)
class PlugInFamily:
    """All plug-ins of a package, as one named union that is told apart by `kind`.

    `nested`: the types of options that are plug-ins themselves, by their base class; `parts`: a family whose schemas
    this one takes over; `elsewhere`: options that are stated elsewhere; `only`: which plug-ins belong to the family.
    """

    name: str
    suffix: str
    package: ModuleType
    nested: Mapping[type[Any], Any] = dataclasses.field(default_factory=dict)
    parts: "PlugInFamily | None" = None
    elsewhere: frozenset[str] = frozenset()
    only: Callable[[type[Any]], bool] = lambda plug_in: True

    @cached_property
    def models(self) -> Mapping[str, type[PlugInDocument]]:
        """The schema of each plug-in by its kind."""
        taken = self.parts.models if self.parts else {}
        return {kind: taken.get(kind) or _schema(plug_in, self) for kind, plug_in in self.plug_ins.items()}

    @cached_property
    def plug_ins(self) -> Mapping[str, type[Any]]:
        """The plug-ins by their kind."""
        return {kind: plug_in for kind, plug_in in discover(self.package).items() if self.only(plug_in)}

    @cached_property
    def union(self) -> Any:
        """The type to annotate a field with."""
        return named_union(self.name, self.models.values(), "kind")


def named_union(name: str, members: Iterable[type[Any]], discriminator: str) -> Any:
    """A union with a name of its own in the OpenAPI document; a single member stands for itself."""
    every = tuple(members)
    alias: Any = TypeAliasType
    if len(every) == 1:
        return every[0]
    return alias(name, typing.Annotated[_union(every), Field(discriminator=discriminator)])


def _union(members: Iterable[Any]) -> Any:
    return reduce(operator.or_, members)


def _schema(plug_in: type[Any], family: PlugInFamily) -> type[PlugInDocument]:
    stated = [f for f in dataclasses.fields(plug_in) if f.name not in family.elsewhere]
    others = {f.name for f in dataclasses.fields(plug_in)} & family.elsewhere

    def build(self: PlugInDocument, **given: Any) -> Any:
        own = {f.name: _frozen(getattr(self, f.name)) for f in stated}
        return plug_in(**own, **{name: value for name, value in given.items() if name in others})

    def buildable(self: PlugInDocument) -> PlugInDocument:
        if not others:
            build(self)
        return self

    hints = typing.get_type_hints(plug_in, include_extras=True)
    options = {f.name: _option(f, hints[f.name], family.nested) for f in stated}
    name = plug_in.__name__ if plug_in.__name__.endswith(family.suffix) else plug_in.__name__ + family.suffix
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


def _option(field: "dataclasses.Field[Any]", hint: Any, nested: Mapping[type[Any], Any]) -> tuple[Any, Any]:
    description, hint = _described(hint)
    kind = _json_type(hint, nested)
    if field.default is not dataclasses.MISSING:
        return kind, Field(default=_thawed(field.default), description=description)
    if field.default_factory is not dataclasses.MISSING:
        default = field.default_factory
        return kind, Field(default_factory=lambda: _thawed(default()), description=description)
    return kind, Field(description=description)


def _described(hint: Any) -> tuple[str, Any]:
    if typing.get_origin(hint) is typing.Annotated:
        inner, *notes = typing.get_args(hint)
        return next((note for note in notes if isinstance(note, str)), ""), inner
    return "", hint


def _json_type(hint: Any, nested: Mapping[type[Any], Any]) -> Any:
    """The type of a document field for the type of an option: sequences become lists, numbers finite."""
    hint = _described(hint)[1]
    if hint in (int, float):
        return Integer if hint is int else Double
    if hint in nested:
        return nested[hint]
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        return _union(_json_type(argument, nested) for argument in arguments)
    if origin in (tuple, list) or hint is np.ndarray:
        inner = _LIST[_json_type(arguments[0], nested)]
        if origin is tuple and arguments[-1] is not Ellipsis:
            return typing.Annotated[inner, Field(min_length=len(arguments), max_length=len(arguments))]
        return inner
    return hint


def _frozen(value: Any) -> Any:
    """Lists as tuples, nested plug-ins as themselves."""
    if isinstance(value, PlugInDocument):
        return value.build()
    return tuple(_frozen(item) for item in value) if isinstance(value, list) else value


def _thawed(value: Any) -> Any:
    return [_thawed(item) for item in value] if isinstance(value, tuple) else value
