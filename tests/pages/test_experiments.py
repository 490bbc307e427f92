"""Files of all formats by drag and drop, a broken one with its problem at the field, and what is seen of a record."""

import base64
import json
from typing import Any

import numpy as np
import pytest

from app.files import csv_writer, mat_writer, npz_writer
from tests.support.api import Api, Json
from tests.support.browser import Visit
from tests.support.paper import PLANT, played
from tests.support.server import Server

DROP = """([files]) => {
  const transfer = new DataTransfer();
  for (const [name, content] of files) {
    const bytes = Uint8Array.from(atob(content), (character) => character.charCodeAt(0));
    transfer.items.add(new File([bytes], name));
  }
  for (const kind of ["dragenter", "dragover", "drop"]) {
    document.getElementById("drop").dispatchEvent(new DragEvent(kind, { dataTransfer: transfer, bubbles: true }));
  }
}"""


def drop(visit: Visit, files: dict[str, bytes]) -> None:
    given = [[name, base64.b64encode(content).decode()] for name, content in files.items()]
    visit.page.evaluate(DROP, [given])


def columns(periods: int = 4, names: tuple[str, str, str] = ("time", "input", "output")) -> dict[str, Any]:
    generator = np.random.default_rng(5)
    u = np.tile(generator.standard_normal(100), periods)
    return dict(zip(names, (np.arange(len(u)) * 1.0, u, played(3.0, u, generator)), strict=True))


@pytest.fixture(scope="module")
def plant(server: Server) -> Json:
    return Api(server.url).post("/plants", {**PLANT, "name": "dropped on"})


@pytest.fixture
def here(visit: Visit, plant: Json) -> Visit:
    visit.open(f"/plants/{plant['id']}/experiments")
    return visit


def row(visit: Visit, name: str) -> str:
    return visit.page.get_by_role("row", name=name).inner_text()


def test_all_formats_are_dropped_and_read(here: Visit) -> None:
    record = columns()
    response = {"frequencyHz": np.arange(1, 40) / 100, "responseRe": np.ones(39), "responseIm": np.zeros(39)}
    body = {"kind": "timeRecord", "sampleTimeSeconds": 1.0} | {k: record[k].tolist() for k in ("input", "output")}
    drop(
        here,
        {
            "one_at_1.csv": csv_writer.write(record),
            "two_at_2.npz": npz_writer.write(record),
            "three_at_3.mat": mat_writer.write(record),
            "four_at_4.json": json.dumps(body).encode(),
            "five_at_5.csv": csv_writer.write(response),
        },
    )
    here.page.get_by_role("button", name="Bring in all 5 files").click()
    for number, name in enumerate(("one", "two", "three", "four", "five"), start=1):
        assert f"p = {number}" in row(here, f"{name}_at_{number}")
    assert "frequency response" in row(here, "five_at_5")
    here.page.locator("#incoming form").first.wait_for(state="detached")


def test_columns_with_other_names_are_chosen(here: Visit) -> None:
    content = csv_writer.write(columns(names=("clock", "force", "way")))
    drop(here, {"named_otherwise_at_2.csv": content})
    page = here.page
    for label, column in (("time (s)", "clock"), ("input", "force"), ("output", "way")):
        page.get_by_label(label, exact=True).select_option(column)
    page.get_by_role("button", name="Bring in").click()
    assert "p = 2" in row(here, "named_otherwise_at_2")


def test_a_question_is_answered_in_the_preview_for_all_files(here: Visit) -> None:
    response = {"Frequency": np.arange(1, 40) / 100, "Zre": np.ones(39), "-Zim": np.linspace(0.1, 0.2, 39)}
    drop(here, {f"asked_at_{k}.csv": csv_writer.write(response) for k in (1, 2)})
    page = here.page
    first, second = page.locator("#incoming form").nth(0), page.locator("#incoming form").nth(1)
    for card in (first, second):
        card.get_by_text("states no unit").wait_for()
        assert "minus imaginary part" in card.get_by_role("row", name="-Zim").inner_text()
    first.get_by_label("unit of Frequency").fill("Hz")
    first.get_by_label("unit of Frequency").press("Tab")
    first.get_by_text("The response, thinned.").wait_for()
    first.get_by_role("button", name="Use these units for all files").click()
    second.get_by_text("The response, thinned.").wait_for()
    assert here.violations() == []
    page.get_by_role("button", name="Bring in all 2 files").click()
    for k in (1, 2):
        assert f"p = {k}" in row(here, f"asked_at_{k}")
    drop(here, {"later_at_3.csv": csv_writer.write(response)})
    page.get_by_text("What was said of the plant's last file is used again.").wait_for()
    page.get_by_role("button", name="Bring in").click()
    assert "p = 3" in row(here, "later_at_3")


def test_a_broken_file_shows_its_problem_at_the_field(here: Visit) -> None:
    drop(here, {"broken.csv": b"time,input,output\n0,1,2\n1,one,3\n"})
    page = here.page
    page.get_by_role("button", name="Bring in").click()
    page.get_by_text("give a number").wait_for()
    assert page.get_by_label("p", exact=True).get_attribute("aria-invalid") == "true"
    here.expect_refusal(422)
    page.get_by_label("p", exact=True).fill("3")
    page.get_by_role("button", name="Bring in").click()
    heading = page.locator("#incoming h3")
    heading.get_by_text("the file is not a table of numbers").wait_for()
    assert here.violations() == []
    page.get_by_role("button", name="Leave out").click()
    page.locator("#incoming form").first.wait_for(state="detached")


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("cut.npz", npz_writer.write(columns())[:200], "not a whole npz file"),
        ("none.mat", b"MATLAB" * 100, "no MATLAB file of level 5 or 7.3"),
        ("none.json", b"{not json", "the file is no JSON"),
        ("other.json", b'{"kind": "timeRecord"}', "please fill this in"),
        ("notes.pdf", b"%PDF", "files of this kind are not read"),
    ],
)
def test_what_is_no_measurement_is_told_so(here: Visit, name: str, content: bytes, told: str) -> None:
    drop(here, {name: content})
    button = here.page.get_by_role("button", name="Bring in")
    if name != "notes.pdf":
        here.page.get_by_label("p", exact=True).fill("3")
        button.click()
    here.page.locator("#incoming").get_by_text(told).first.wait_for()
    if name == "other.json":
        here.expect_refusal(422)


def test_a_record_is_seen_with_its_spectrum_and_what_was_understood(here: Visit, server: Server, plant: Json) -> None:
    stated = {"plantId": plant["id"], "operatingPoint": [3.0]}
    experiment = Api(server.url).uploaded("seen.csv", csv_writer.write(columns()), **stated)
    page = here.open(f"/plants/{plant['id']}/experiments/{experiment['id']}")
    facts = page.locator(".facts").inner_text()
    assert "4 × 100 samples" in facts
    assert "noise level" in facts
    here.draw_all()
    assert page.locator(".plot .main-svg").count() >= 4
    page.get_by_text("The numbers behind it").last.click()
    table = page.get_by_role("region", name="Amplitudes of the lines")
    table.get_by_role("row").nth(51).wait_for()
    assert here.violations() == []
