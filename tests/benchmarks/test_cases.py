"""A folder of campaigns is read, diagnosed, answered and predicted for; what breaks says why."""

import json
import sys

import numpy as np
import pytest

from benchmarks.cases.__main__ import main
from benchmarks.cases.reading import channel, read, stated
from tests.support import campaigns


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    drive = campaigns.drive_case("friction", 0.3, 1)
    cell = campaigns.impedance_case("cell", 2e-6, 2)
    broken = (drive[0] | {"case": "broken"}, {"fitted0_u": np.ones(4)})
    made = campaigns.write(tmp_path_factory.mktemp("cases"), [drive[:2], cell[:2], broken])
    np.savez(made / "truth.npz", friction=drive[2], cell=cell[2])
    return made


@pytest.fixture(scope="module")
def answers(folder):
    output = folder / "RESULTS.json"
    arguments, sys.argv = sys.argv, ["cases", str(folder), "--output", str(output)]
    try:
        main()
    finally:
        sys.argv = arguments
    return {one["case"]: one for one in json.loads(output.read_text())}


def off(said, truth):
    return np.linalg.norm(said - truth) / np.linalg.norm(truth)


def test_an_inductance_in_a_cell_is_found_and_predicts_what_was_held_out(folder, answers):
    one = answers["cell"]
    assert one["announced"][0] == "inductance"
    assert one["verdict"] == "explained"
    (effect,) = one["added"]
    assert effect["amplitude"] == pytest.approx(2e-6, rel=0.05)
    assert effect["at"] is None
    truth = np.load(folder / "truth.npz")["cell"]
    said = np.load(folder / one["predictions"])
    assert off(said["after_held_out0"], truth) < 0.005 < off(said["before_held_out0"], truth)


def test_predictions_of_records_repeat_the_steady_period(folder, answers):
    one = answers["friction"]
    said, truth = np.load(folder / one["predictions"]), np.load(folder / "truth.npz")["friction"]
    assert sorted(said) == [f"{when}_held_out{i}" for when in ("after", "before") for i in (0, 1)]
    for i in (0, 1):
        before = said[f"before_held_out{i}"]
        assert before.shape == truth[i].shape
        assert np.array_equal(before[:256], before[256:512])
        assert off(before, truth[i]) < 0.3
    assert set(one) >= {"verdict", "announced", "confident", "added", "seconds"}


def test_a_case_that_breaks_cannot_be_judged_and_says_why(answers):
    one = answers["broken"]
    assert (one["verdict"], one["announced"], one["confident"], one["added"]) == ("cannotBeJudged", [], False, [])
    assert "fitted0_y" in one["reason"]
    assert one["predictions"] is None


def test_what_a_user_says_reaches_the_records(folder):
    (entry,) = stated(folder, ["friction"])
    case = read(entry | {"closed_loop": True, "input_between_samples": "zero_order_hold"}, folder)
    first = case.fitted[0]
    assert (first.hold, first.feedback, first.period, len(first)) == ("zero", True, 256, 1024)
    assert (first.channels.input.quantity, first.channels.output.quantity) == ("torque", "angular velocity")
    with pytest.raises(SystemExit, match="no case nowhere"):
        stated(folder, ["nowhere"])


@pytest.mark.parametrize(
    ("word", "unit", "quantity"),
    [
        ("speed", "m/s", "velocity"),
        ("Rotational_speed", "rpm", "angular velocity"),
        ("heat flow", "W", "heat flow"),
        ("acceleration", "rad/s^2", "angular acceleration"),
        ("acceleration", "m/s^2", "acceleration"),
        ("moment", "N m", "torque"),
        ("brightness", "lx", None),
        (None, "", None),
    ],
)
def test_words_of_others_are_understood(word, unit, quantity):
    assert channel({"quantity": word, "unit": unit}).quantity == quantity
