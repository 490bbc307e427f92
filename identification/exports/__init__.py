"""What a model becomes elsewhere: one form a file, found by its `kind`."""

import sys
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cache
from typing import ClassVar

from identification.models.model import Model
from identification.registry import discover


class Export(ABC):
    """Writes a model for another program; `ending` of the file, `title` in words."""

    kind: ClassVar[str]
    title: ClassVar[str]
    ending: ClassVar[str]

    @classmethod
    @abstractmethod
    def written(cls, model: Model) -> str:
        """The file's text; raises MisuseError where the model cannot be written so."""


@cache
def exports() -> Mapping[str, type[Export]]:
    """The exports by their kinds."""
    return discover(sys.modules[__name__])
