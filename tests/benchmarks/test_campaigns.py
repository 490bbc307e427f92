"""The same seed makes the same campaign, linear ones obey their own equation, and answers are judged by the truth."""

import json

import numpy as np
import pytest

from benchmarks.campaigns import laws
from benchmarks.campaigns.campaign import Truth, write
from benchmarks.campaigns.integrator import band_limited, integrate
from benchmarks.campaigns.judging import held_out_errors, judged
from benchmarks.campaigns.kinds import kinds
from benchmarks.campaigns.stage import PERIOD, played, stage

QUICK = ("hum", "clock_skew", "quantised", "misplaced_point", "low_basis", "two_mass", "three_in_a_cell")


def said(verdict="explained", announced=("coulomb_friction",), confident=True, amplitude=4.0, at=None):
    added = [{"kind": kind, "amplitude": amplitude, "standardError": 0.1, "at": at} for kind in announced]
    return {"case": "one", "verdict": verdict, "announced": list(announced), "confident": confident, "added": added}


@pytest.mark.parametrize("name", QUICK)
def test_the_same_seed_makes_the_same_campaign(name):
    one, other = (kinds()[name](name, np.random.default_rng(3)) for _ in range(2))
    assert one.entry == other.entry
    assert all(np.array_equal(one.arrays[key], other.arrays[key]) for key in one.arrays)
    assert all(np.isfinite(array).all() for array in (one.arrays | one.answers).values())


def test_every_kind_says_what_it_hides():
    assert len(kinds()) >= 45
    assert all(kind.__doc__ for kind in kinds().values())


def test_the_integrator_is_of_fourth_order():
    lines, amplitude = np.array([3]), np.array([[1.0 + 0j]])
    drive = np.tile(band_limited(amplitude, lines, 64), (8, 1, 1))
    states = integrate(lambda x, u, t: u - x, np.zeros((1, 1)), drive, 0.1)
    omega = 2 * np.pi * 3 / 6.4
    steady = np.real(np.exp(1j * omega * 0.1 * np.arange(64)) / (1 + 1j * omega))
    assert np.abs(states[-64:, 0, 0] - steady).max() < 1e-7


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_stage_without_a_law_answers_as_its_response(order):
    made = played("one", Truth(), stage(np.random.default_rng(2), order), np.random.default_rng(5))
    plant = stage(np.random.default_rng(2), order)
    u, y = (np.fft.rfft(made.arrays["held_out0_u"]), np.fft.rfft(made.answers["held_out0_y"][:PERIOD]))
    lines = np.flatnonzero(abs(u) > 1e-6 * abs(u).max())
    p = made.entry["experiments"][8]["operating_point"][0]
    expected = plant.response(p, plant.frequencies(lines))
    assert np.abs(y[lines] / u[lines] - expected).max() < 2e-3 * np.abs(expected).max()


def test_friction_opposes_the_motion():
    law = laws.asymmetric(2.0, 1.0, 1.0)
    assert np.allclose(law(np.zeros(2), np.array([1.0, -1.0])), [2.0, -1.0])


@pytest.mark.parametrize(
    ("answer", "truth", "word"),
    [
        (said(), {"accept": ["coulomb_friction"], "amplitude": 4.2}, "right"),
        (said(), {"accept": ["coulomb_friction"], "amplitude": 6.0}, "confidently wrong"),
        (said(), {"accept": ["delay"]}, "confidently wrong"),
        (said("partlyExplained", confident=False), {"accept": ["delay"]}, "wrong"),
        (said("nothingMissing", ()), {"accept": ["delay"]}, "confidently wrong"),
        (said("nothingMissing", ()), {"nothing_is_right": True}, "right"),
        (said("cannotBeJudged", (), False), {"accept": ["delay"]}, "honest"),
        (said("notInTheLibrary", ("delay",), False), {"accept": ["delay"]}, "honest"),
        (said(announced=("coulomb_friction", "delay")), {"accept": ["coulomb_friction"]}, "confidently wrong"),
        (said(announced=("misplaced_point",), at=0.3), {"accept": ["misplaced_point"], "at": 0.5}, "confidently wrong"),
        (said(announced=("offset", "coulomb_friction")), {"accept": [("coulomb_friction", "offset")]}, "right"),
    ],
)
def test_an_answer_is_judged(answer, truth, word):
    assert judged(answer, truth) == word


def test_errors_are_those_of_what_was_held_out(tmp_path):
    made = kinds()["hum"]("hum", np.random.default_rng(1))
    write(tmp_path, [made])
    assert json.loads((tmp_path / "truth.json").read_text())["hum"]["accept"] == ["hum"]
    predictions = {f"before_{name[:-2]}": 0.9 * y for name, y in made.answers.items()}
    predictions |= {f"after_{name[:-2]}": y for name, y in made.answers.items()}
    np.savez(tmp_path / "R_hum.npz", **predictions)
    answer = {"case": "hum", "predictions": "R_hum.npz"}
    before, after = held_out_errors(answer, tmp_path / "RESULTS.json", tmp_path / "answers")
    assert before == pytest.approx(0.1, rel=0.05)
    assert after == 0
