"""Misuse in a job, named by the fields of the request that the job was started with."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from identification.errors import MisuseError


@contextmanager
def field_named(names: Mapping[str, str], default: str | None = None) -> Iterator[None]:
    """Raise MisuseError again with the name of the field in the request; `default` for arguments not in `names`."""
    try:
        yield
    except MisuseError as error:
        raise MisuseError(str(error), names.get(error.field or "", default)) from error
