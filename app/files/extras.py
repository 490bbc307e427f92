"""Libraries that are installed on demand."""

from importlib import import_module
from typing import Any

from app.files.contents import FileError


def needed(module: str, extra: str) -> Any:
    """A library that reads one kind of file; raises FileError with what to install where it is missing."""
    try:
        return import_module(module)
    except ImportError:
        raise FileError(
            f"this kind of file needs a library that is not installed here: pip install 'lpv-oed[{extra}]', then start"
            " the service again; or save the measurement as text or .mat"
        ) from None
