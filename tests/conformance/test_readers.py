"""Every reader reads its own example, recognises it by name and content, and ends damage in a FileError or a table."""

import contextlib

import numpy as np
import pytest

from app.files.contents import FileError, Table
from app.files.measurement import Statements, read_measurement
from app.files.readers import endings, kind_of_file, readers
from identification.errors import MisuseError

KINDS = sorted(readers())


@pytest.mark.parametrize("kind", KINDS)
def test_its_example_is_a_measurement(kind: str) -> None:
    reader = readers()[kind]
    assert reader.title
    data = read_measurement(reader.example(), kind, Statements((1.0,)))
    assert len(data) >= 8


@pytest.mark.parametrize("kind", KINDS)
def test_it_is_found_by_name_and_content(kind: str) -> None:
    reader = readers()[kind]
    for ending in reader.endings:
        assert ending == ending.lower()
        assert ending in endings()
        assert kind_of_file(f"Measured At 5.{ending.upper()}", reader.example()) == kind


@pytest.mark.parametrize("kind", KINDS)
def test_damage_is_said_and_never_a_fault(kind: str) -> None:
    generator, content = np.random.default_rng(7), readers()[kind].example()
    for _ in range(25):
        broken = bytearray(content[: int(generator.integers(1, len(content) + 1))])
        for where in generator.integers(0, len(broken), 4):
            broken[where] = int(generator.integers(0, 256))
        found: list[Table] = []
        with contextlib.suppress(MisuseError):  # anything else is a fault
            found = readers()[kind].read(bytes(broken))
        assert all(isinstance(table, Table) for table in found)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_of_another_kind_is_refused(kind: str) -> None:
    with pytest.raises(FileError):
        readers()[kind].read(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(600))
