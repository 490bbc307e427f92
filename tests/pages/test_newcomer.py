"""From an empty data directory and files on a disc to a model whose error has fallen: by clicks and files alone."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.files import csv_writer, mat_writer, npz_writer
from tests.support.browser import Visit
from tests.support.hidden_plant import SAMPLE_TIME, HiddenPlant
from tests.support.server import Server, running_server

FITTED, HELD_OUT = [-1.0, -0.5, 0.0, 0.5, 1.0], [-0.7, 0.3]
LEVELS = (20.0, 10.0)
WRITERS = {"csv": csv_writer.write, "npz": npz_writer.write, "mat": mat_writer.write}
FIELDS = {
    "/name": "sprung mass",
    "/input/name": "force",
    "/input/unit": "N",
    "/output/name": "way",
    "/output/unit": "m",
    "/schedulingVariables/0/name": "preload",
    "/schedulingVariables/0/minimum": "-1",
}


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server with an empty data directory."""
    with running_server(tmp_path_factory.mktemp("empty") / "data") as running:
        yield running


def measured(folder: Path) -> list[Path]:
    """Files of a mass on a spring whose cubic part the model does not know, in all formats."""
    files = []
    for points, stem, levels in ((FITTED, "run", LEVELS), (HELD_OUT, "held out", LEVELS[:1])):
        for level in levels:
            records = HiddenPlant(6.0).records(points, level, seed=len(files))
            for point, body in zip(points, records, strict=True):
                ending = ("csv", "npz", "mat")[len(files) % 3]
                u, y = np.array(body["input"]), np.array(body["output"])
                columns = {"time": np.arange(len(u)) * SAMPLE_TIME, "input": u, "output": y}
                files.append(folder / f"{stem} {level:g} N at {point}.{ending}")
                files[-1].write_bytes(WRITERS[ending](columns))
    return files


def test_files_alone_lead_to_an_error_that_has_fallen(visit: Visit, tmp_path: Path) -> None:
    page = visit.open("/")
    assert "There is no plant yet" in page.locator("#plants").inner_text()
    page.get_by_role("link", name="Describe a plant").click()
    page.get_by_role("button", name="Keep this plant").wait_for()
    for pointer, text in FIELDS.items():
        page.locator(f'[data-pointer="{pointer}"]').fill(text)
    page.get_by_role("button", name="Keep this plant").click()
    page.get_by_role("link", name="bring in what you have measured").click()
    files = measured(tmp_path)
    page.locator("#files").set_input_files(files)
    page.get_by_role("button", name=f"Bring in all {len(files)} files").click()
    page.locator("#experiments tbody tr").nth(len(files) - 1).wait_for()
    page.get_by_role("link", name="Identify").click()
    held_out = page.get_by_label("What held out")
    held_out.nth(len(HELD_OUT) - 1).wait_for()
    assert held_out.count() == len(HELD_OUT)
    page.get_by_role("button", name="Identify a model").click()
    page.get_by_role("button", name="Look for what is missing").click()
    page.locator("#ranking li").first.get_by_role("button", name="Add this effect").click()
    headline = page.locator("#headline")
    headline.wait_for()
    assert "cubic stiffness" in headline.inner_text()
    assert "The error has fallen on the held-out experiments" in headline.inner_text()
