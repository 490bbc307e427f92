"""Array files: the same arrays are the same file, and a crash at any moment leaves no half of one."""

import os
import signal
import subprocess
import sys
import textwrap
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from app.store.arrays import ArraysDamagedError, ArraysTooLargeError, ArrayStore, encode

DTYPES = st.one_of(
    hnp.floating_dtypes(endianness="<"), hnp.complex_number_dtypes(endianness="<"), hnp.integer_dtypes(endianness="<")
)
ARRAYS = st.dictionaries(
    st.from_regex(r"[a-z_]{1,8}", fullmatch=True),
    hnp.arrays(DTYPES, hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)),
    max_size=3,
)


@pytest.fixture
def store(tmp_path: Path) -> ArrayStore:
    made = ArrayStore(tmp_path / "arrays", max_bytes=10_000)
    made.prepare()
    return made


@given(arrays=ARRAYS)
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_there_and_back(store: ArrayStore, arrays: dict[str, np.ndarray]) -> None:
    found = store.get(store.put(arrays))
    assert found.keys() == arrays.keys()
    for name, array in arrays.items():
        assert found[name].dtype == array.dtype
        np.testing.assert_array_equal(found[name], array)


def test_the_hash_depends_on_the_content_alone(store: ArrayStore) -> None:
    a, b = np.arange(6.0).reshape(2, 3), np.arange(3)
    assert encode({"a": a, "b": b}) == encode({"b": b, "a": np.asfortranarray(a)})
    digests = [store.put(arrays) for arrays in ({"a": a}, {"b": a}, {"a": a.T}, {"a": a.astype("f4")}, {"a": a + 1})]
    assert len(set(digests)) == 5


def test_the_file_is_an_ordinary_npz_without_compression(store: ArrayStore) -> None:
    path = store.path(store.put({"u": np.ones(5)}))
    assert path.name == f"{path.parent.name}{path.name[2:]}"
    with np.load(path, allow_pickle=False) as archive:
        assert archive["u"].tolist() == [1.0] * 5
    with zipfile.ZipFile(path) as archive:
        assert {item.compress_type for item in archive.infolist()} == {zipfile.ZIP_STORED}


def test_objects_and_too_much_are_refused(store: ArrayStore) -> None:
    with pytest.raises(ValueError, match="Object arrays"):
        store.put({"a": np.array([{}], dtype=object)})
    with pytest.raises(ArraysTooLargeError, match="16000 bytes"):
        store.put({"a": np.zeros(1000), "b": np.zeros(1000)})


def test_damage_is_seen_and_mended_by_the_next_put(store: ArrayStore) -> None:
    arrays = {"a": np.arange(10)}
    digest = store.put(arrays)
    content = bytearray(store.path(digest).read_bytes())
    content[-100] ^= 1
    store.path(digest).write_bytes(content)
    with pytest.raises(ArraysDamagedError, match="changed"):
        store.get(digest)
    assert store.put(arrays) == digest
    assert store.get(digest)["a"].tolist() == list(range(10))
    store.path(digest).unlink()
    with pytest.raises(ArraysDamagedError, match="missing"):
        store.get(digest)


def test_writers_of_the_same_arrays_do_not_disturb_each_other(store: ArrayStore) -> None:
    arrays = {"a": np.arange(1000)}
    with ThreadPoolExecutor(8) as pool:
        digests = set(pool.map(lambda _: store.put(arrays), range(40)))
    assert len(digests) == 1
    assert store.get(digests.pop())["a"].size == 1000


WRITER = """
    import sys, numpy as np
    from pathlib import Path
    from app.store.arrays import ArrayStore
    store = ArrayStore(Path(sys.argv[1]), 10**9)
    for number in range(10**6):
        sys.stdout.write(store.put({"a": np.full(20_000, number)}) + "\\n")
        sys.stdout.flush()
"""


def test_killed_in_the_middle_of_writing(tmp_path: Path, repository: Path) -> None:
    root = tmp_path / "arrays"
    store = ArrayStore(root, 10**9)
    store.prepare()
    environment = {**os.environ, "PYTHONPATH": str(repository)}
    acknowledged: list[str] = []
    for lines in (3, 7, 12):
        command = [sys.executable, "-c", textwrap.dedent(WRITER), str(root)]
        writer = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        assert writer.stdout is not None
        acknowledged += [writer.stdout.readline().strip() for _ in range(lines)]
        writer.send_signal(signal.SIGKILL)
        writer.communicate()
    for path in root.glob("??/*"):
        store.get(path.stem)
    for digest in acknowledged:
        assert store.get(digest)["a"].size == 20_000
    (root / "tmp" / "leftover").write_bytes(b"half of")
    store.prepare()
    assert list((root / "tmp").iterdir()) == []
