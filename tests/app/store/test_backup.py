"""Backups while the service works: whatever moment they take, all of it can be read again elsewhere."""

import os
import re
import sqlite3
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event

import numpy as np
import pytest
from fastapi.testclient import TestClient

from app.main import create_app
from app.settings import Settings
from app.store.arrays import ArrayStore, keeping
from app.store.backup import DATABASE, BackupError, backup, restore
from app.store.database import Database
from app.store.resources import ResourceRepository
from app.store.unused import remove_unused
from tests.app.jobs.bench import Bench


def writer(database: Database, store: ArrayStore, stopping: Event, seed: int) -> list[str]:
    """Keeps resources with arrays as fast as it can; returns their identifiers."""
    resources, generator, made = ResourceRepository(database), np.random.default_rng(seed), []
    while not stopping.is_set():
        digest = store.put({"values": generator.standard_normal(200)})
        time.sleep(0.01)
        made.append(resources.add("experiments", {"filling": "x" * 2000}, arrays=digest).id)
    return made


def everything(directory: Path) -> dict[str, tuple[str, list[float]]]:
    """Every document with its arrays, each checked against its hash."""
    store = ArrayStore(directory / "arrays", 2**30)
    with sqlite3.connect(directory / DATABASE) as connection:
        rows = connection.execute("SELECT id, document, arrays FROM resources").fetchall()
    return {row[0]: (row[1], store.get(row[2])["values"].tolist()) for row in rows}


def test_backups_under_load_are_whole_wherever_they_are_restored(tmp_path: Path) -> None:
    data = tmp_path / "data"
    store, stopping = ArrayStore(data / "arrays", 2**30), Event()
    store.prepare()
    database = Database(f"sqlite:///{data / DATABASE}")
    database.migrate()
    with ThreadPoolExecutor(3) as pool:
        writers = [pool.submit(writer, database, store, stopping, seed) for seed in range(3)]
        try:
            for number in range(6):
                backup(data, tmp_path / f"copy {number}")
            backup(data, tmp_path / "copy 0")
        finally:
            stopping.set()
        made = {identifier for one in writers for identifier in one.result()}
    whole, before = everything(data), 0
    assert whole.keys() == made
    for number in (*range(1, 6), 0):
        elsewhere = tmp_path / f"elsewhere {number}"
        copied = restore(tmp_path / f"copy {number}", elsewhere)
        found = everything(elsewhere)
        assert found.items() <= whole.items()
        assert before <= len(found) == copied.rows["resources"]
        before = len(found)
    assert before > 0


def test_a_service_goes_on_from_a_backup_of_a_running_one(settings: Settings, tmp_path: Path) -> None:
    application = create_app(settings)
    with TestClient(application, base_url="http://127.0.0.1") as client:
        bench = Bench(client, application.state.container)
        done = bench.run(name="done")
        running = bench.submit(name="running", hold=str(tmp_path / "go"))
        bench.wait(running, "running")
        backup(settings.data_dir, tmp_path / "copy")
    elsewhere = settings.model_copy(update={"data_dir": tmp_path / "elsewhere"})
    restore(tmp_path / "copy", elsewhere.data_dir)
    (tmp_path / "go").touch()
    application = create_app(elsewhere)
    with TestClient(application, base_url="http://127.0.0.1") as client:
        bench = Bench(client, application.state.container)
        assert bench.look(done["id"]) == done
        assert bench.wait(running)["attempts"] == 2


def small(directory: Path) -> Path:
    database = Database(f"sqlite:///{directory / DATABASE}")
    directory.mkdir()
    database.migrate()
    store = ArrayStore(directory / "arrays", 2**30)
    ResourceRepository(database).add("experiments", {}, arrays=store.put({"values": np.arange(3.0)}))
    database.close()
    return directory


def test_what_is_no_data_directory_or_no_empty_one_is_refused(tmp_path: Path) -> None:
    data = small(tmp_path / "data")
    with pytest.raises(BackupError, match="LPV_OED_DATA_DIR"):
        backup(tmp_path / "nothing", tmp_path / "copy")
    with pytest.raises(BackupError, match="outside"):
        backup(data, data / "copy")
    backup(data, tmp_path / "copy")
    with pytest.raises(BackupError, match="has data already"):
        restore(tmp_path / "copy", data)
    with pytest.raises(BackupError, match="no backup"):
        restore(tmp_path, tmp_path / "elsewhere")


def test_damage_is_seen_when_it_is_copied(tmp_path: Path) -> None:
    data = small(tmp_path / "data")
    backup(data, tmp_path / "copy")
    (file,) = (tmp_path / "copy" / "arrays").glob("??/*.npz")
    content = bytearray(file.read_bytes())
    content[-20] ^= 1
    file.write_bytes(content)
    with pytest.raises(BackupError, match=re.escape(file.name)):
        restore(tmp_path / "copy", tmp_path / "elsewhere")
    assert not (tmp_path / "elsewhere" / DATABASE).exists()


def test_only_what_nothing_names_is_removed_and_not_during_a_backup(tmp_path: Path) -> None:
    data = small(tmp_path / "data")
    store = ArrayStore(data / "arrays", 2**30)
    database = Database(f"sqlite:///{data / DATABASE}")
    (named,) = everything(data).values()
    unnamed, inside, young = (store.put({"values": np.full(5, value)}) for value in (1.0, 2.0, 3.0))
    ResourceRepository(database).add("models", {"made": [{"arrays": inside}]})
    old = time.time() - 1000
    for digest in (unnamed, inside, *(path.stem for path in (data / "arrays").glob("??/*.npz"))):
        if digest != young:
            os.utime(store.path(digest), (old, old))
    with keeping(data / "arrays"):
        assert remove_unused(database, data / "arrays", 500) == 0
    size = store.path(unnamed).stat().st_size
    assert remove_unused(database, data / "arrays", 500) == size
    assert not store.path(unnamed).exists()
    assert store.get(inside)["values"].tolist() == [2.0] * 5
    assert store.path(young).exists()
    assert named[1] == [0.0, 1.0, 2.0]


def test_what_is_put_again_is_young_again(tmp_path: Path) -> None:
    store = ArrayStore(tmp_path, 2**30)
    digest = store.put({"values": np.arange(3)})
    os.utime(store.path(digest), (0, 0))
    store.put({"values": np.arange(3)})
    assert store.path(digest).stat().st_mtime > 0


def test_the_upload_of_a_failed_job_goes_and_that_of_a_waiting_one_stays(settings: Settings, tmp_path: Path) -> None:
    application = create_app(settings)
    with TestClient(application, base_url="http://127.0.0.1") as client:
        bench = Bench(client, application.state.container)
        store = bench.container.arrays
        failed, waiting = (store.put({"file": np.full(5, value)}) for value in (1, 2))
        bench.run(end="misuse", arrays=failed)
        job = bench.submit(arrays=waiting, hold=str(tmp_path / "go"))
        for digest in (failed, waiting):
            os.utime(store.path(digest), (0, 0))
        assert remove_unused(bench.container.database, settings.arrays_dir, 3600) > 0
        assert not store.path(failed).exists()
        assert store.path(waiting).exists()
        (tmp_path / "go").touch()
        assert bench.wait(job)["state"] == "succeeded"
