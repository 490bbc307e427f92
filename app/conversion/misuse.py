"""Misuse that the numeric packages report, pointed to the field of the request that it comes from."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from app.errors import UnprocessableError
from identification.errors import MisuseError


@contextmanager
def pointing(pointers: Mapping[str, str], default: str = "", location: str = "body") -> Iterator[None]:
    """Turn MisuseError into a problem; `pointers` from names of arguments to JSON pointers."""
    try:
        yield
    except MisuseError as error:
        raise UnprocessableError.at(pointers.get(error.field or "", default), str(error), location) from error
