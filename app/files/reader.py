"""What a reader of a kind of file is."""

from abc import ABC, abstractmethod
from typing import ClassVar

from app.files.contents import Table


class Reader(ABC):
    """Reads one kind of file into tables; one file each in `app/files/readers/`, found there by its `kind`.

    `title`: in words; `endings`: of file names, without the dot. What a reader needs beyond the project's own
    dependencies is imported when it reads, and named in `needs` with how it is installed.
    """

    kind: ClassVar[str]
    title: ClassVar[str]
    endings: ClassVar[tuple[str, ...]]
    specific: ClassVar[bool] = False

    @classmethod
    def recognises(cls, head: bytes) -> bool:
        """Whether the first bytes of a file (some thousands) are of this kind; endings are shared by several kinds."""
        return True

    @classmethod
    @abstractmethod
    def read(cls, content: bytes) -> list[Table]:
        """The tables in a file; raises FileError with what to do when it is damaged or of another kind."""

    @classmethod
    @abstractmethod
    def example(cls) -> bytes:
        """A small file of this kind with a measurement in it, as the instrument or program writes it."""
