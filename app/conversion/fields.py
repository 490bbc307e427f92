"""Misuse in a job, named by the fields of the request that the job was started with."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from identification.errors import MisuseError


@contextmanager
def field_named(names: Mapping[str, str], default: str | None = None) -> Iterator[None]:
    """Raise MisuseError again with the pointer to the field of the request; `default` for arguments not in `names`.

    Names are JSON pointers; an error that has one already keeps it.
    """
    try:
        yield
    except MisuseError as error:
        field = error.field or ""
        raise MisuseError(str(error), field if field.startswith("/") else names.get(field, default)) from error
