"""Misuse that the numeric packages report, pointed to the field of the request that it comes from."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from app.errors import UnprocessableError
from identification.errors import MisuseError


@contextmanager
def pointing(pointers: Mapping[str, str], default: str = "", location: str = "body") -> Iterator[None]:
    """Turn MisuseError into a problem; `pointers` from arguments to JSON pointers, which are kept as they are."""
    try:
        yield
    except MisuseError as error:
        field = error.field or ""
        pointer = field if field.startswith("/") else pointers.get(field, default)
        raise UnprocessableError.at(pointer, str(error), location) from error
