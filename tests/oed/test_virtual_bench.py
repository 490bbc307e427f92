"""Designs on the virtual bench, whose plants are integrated by a code that shares nothing with the models."""

import numpy as np

from app.report.page import render
from benchmarks.deciding_experiments import PAIRS, one_run, picture, summary
from benchmarks.detection_power import problem, seen
from benchmarks.virtual_bench.played import steady
from oed.design import design

RUNS = 40


def test_a_cubic_stiffness_is_seen_as_often_as_designed() -> None:
    found = design(problem(0.05))
    played = [(one.operating_point[0], one.spectrum) for one in found.experiments]
    assert 0.9 <= found.decisions[0][1].power < 0.96
    there, nothing = steady(played, (("cubic_stiffness", 0.05),)), steady(played, ())
    assert 31 <= np.sum([seen(played, there, seed) for seed in range(RUNS)]) <= RUNS
    assert np.sum([seen(played, nothing, seed) for seed in range(RUNS)]) <= 7


def test_a_designed_experiment_decides_what_the_first_left_open() -> None:
    stiffness, sensor = PAIRS[1].effects
    runs = [one_run((1, stiffness, 0, False)), one_run((1, sensor, 0, False))]
    name = " / ".join(PAIRS[1].effects)
    table = summary(runs)[name]
    assert table["designed"]["right"] == 1.0
    assert table["designed"]["energy over budget"] <= 1.0
    assert max(max(run["first"].values()) for run in runs) <= 0.95
    assert name in render(picture(summary(runs)))
