"""Arrays in content-addressed files: the name is the SHA-256 of the content, so a file never changes."""

import fcntl
import hashlib
import io
import os
import time
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from app.store.faults import StorageFullError
from app.store.room import free_bytes

Array = NDArray[Any]
SECONDS_OF_A_DAY = 86_400.0
_EPOCH = (1980, 1, 1, 0, 0, 0)


class ArraysTooLargeError(ValueError):
    """The arrays exceed the limit on one file."""


class ArraysDamagedError(RuntimeError):
    """A file is missing or is not what was written."""


class ArrayStore:
    """Keeps sets of named arrays as `<root>/ab/<sha256>.npz`. Safe against a crash at any moment.

    A file appears under its name only when all of it is on the disk, so a reader never sees part of one, and two
    writers of the same arrays write the same file. Commit the row that names the hash after `put` has returned.
    """

    def __init__(self, root: Path, max_bytes: int, reserve: int = 0) -> None:
        self._root = root
        self._reserve = reserve
        self._temporary = root / "tmp"
        self._max_bytes = max_bytes

    def prepare(self, shared: bool = False) -> None:
        """Make the directories and remove what a crash left behind; if they are `shared`, only what is a day old."""
        self._temporary.mkdir(parents=True, exist_ok=True)
        end = time.time() - SECONDS_OF_A_DAY if shared else float("inf")
        for leftover in self._temporary.iterdir():
            with suppress(FileNotFoundError):
                if leftover.stat().st_mtime < end:
                    leftover.unlink()
        _sync_directory(self._root)

    def put(self, arrays: Mapping[str, Array]) -> str:
        """Keep `arrays`; durable on return.

        Returns the SHA-256 in hexadecimal, the same for the same names, types, shapes and values.
        Raises ArraysTooLargeError beyond the limit, ValueError for arrays of Python objects, and StorageFullError,
        leaving nothing behind, when less than the reserve would be left of the disk.
        """
        self._check_size(arrays)
        content = encode(arrays)
        digest = hashlib.sha256(content).hexdigest()
        path = self.path(digest)
        with keeping(self._root):
            if self._is_intact(digest):
                os.utime(path)
            else:
                self._write(path, content)
        _sync_directory(path.parent)
        _sync_directory(self._root)
        return digest

    def get(self, digest: str) -> dict[str, Array]:
        """The arrays of a hash; raises ArraysDamagedError when the file is missing or changed."""
        content = self.read(digest)
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}

    def read(self, digest: str) -> bytes:
        """The npz file of a hash as it is; raises ArraysDamagedError when it is missing or changed."""
        try:
            content = self.path(digest).read_bytes()
        except FileNotFoundError:
            raise ArraysDamagedError(f"the array file {digest} is missing") from None
        if hashlib.sha256(content).hexdigest() != digest:
            raise ArraysDamagedError(f"the array file {digest} has been changed")
        return content

    def path(self, digest: str) -> Path:
        """Where the file of a hash is."""
        return self._root / digest[:2] / f"{digest}.npz"

    def _check_size(self, arrays: Mapping[str, Array]) -> None:
        size = sum(array.nbytes for array in arrays.values())
        if size > self._max_bytes:
            raise ArraysTooLargeError(f"the arrays take {size} bytes, at most {self._max_bytes} are kept together")

    def _is_intact(self, digest: str) -> bool:
        try:
            self.read(digest)
        except ArraysDamagedError:
            return False
        return True

    def _write(self, path: Path, content: bytes) -> None:
        self._temporary.mkdir(parents=True, exist_ok=True)
        if free_bytes(self._temporary) < len(content) + self._reserve:
            raise StorageFullError(f"no room for {len(content)} bytes beside the reserve of {self._reserve}")
        temporary = self._temporary / uuid4().hex
        try:
            with temporary.open("xb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            path.parent.mkdir(parents=True, exist_ok=True)
            temporary.replace(path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


@contextmanager
def keeping(root: Path) -> Iterator[None]:
    """While files are written or copied: no file is removed."""
    with _lock_of(root).open("a") as file:
        fcntl.flock(file, fcntl.LOCK_SH)
        yield


@contextmanager
def alone(root: Path) -> Iterator[bool]:
    """While files are removed: whether this may be done now, which it may not while a backup is made."""
    with _lock_of(root).open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
        else:
            yield True


def _lock_of(root: Path) -> Path:
    root.mkdir(parents=True, exist_ok=True)
    return root / "keeping.lock"


def encode(arrays: Mapping[str, Array]) -> bytes:
    """An npz file without dates and compression, so that the same arrays give the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(arrays):
            array = np.ascontiguousarray(arrays[name]).reshape(arrays[name].shape)
            with archive.open(zipfile.ZipInfo(f"{name}.npy", _EPOCH), "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, version=(1, 0), allow_pickle=False)
    return buffer.getvalue()


def _sync_directory(directory: Path) -> None:
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
