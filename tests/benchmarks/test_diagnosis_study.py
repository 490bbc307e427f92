"""The studies of the diagnosis in small: right effects, no alarms, unknown ones called so, and pages of all that."""

from statistics import fmean

import numpy as np
import pytest

from app.report.page import render
from benchmarks.virtual_bench import alarms, hits, pairs, pictures, unknown
from benchmarks.virtual_bench.bench import FirstOrderBench, rate
from benchmarks.virtual_bench.figures import most
from benchmarks.virtual_bench.figures import rate as share
from benchmarks.virtual_bench.study import design

FOUND = ("delay", "quadratic_dependence", "quadratic_sensor", "coulomb_friction")


@pytest.fixture(scope="module")
def quiet():
    """Nothing hidden, white and strongly coloured noise."""
    return [alarms.one(task) for number in (0, 11) for task in alarms.tasks(8) if task[0] == number]


@pytest.fixture(scope="module")
def hit():
    every = hits.tasks(1, (0.03,))
    return [hits.one(task) for task in every if task[0] in FOUND]


def test_the_first_order_bench_answers_as_its_equation_says():
    done = design(3)
    response = np.fft.rfft(FirstOrderBench().steady(done))[:, done.lines] / 512
    wanted = done.phasors / 2 / (rate(done.points)[:, None] + 2j * np.pi * done.lines / 25.6)
    assert np.allclose(response, wanted, rtol=1e-4, atol=1e-7)


def test_nothing_hidden_nothing_announced(quiet):
    """Without the projection, or with the noise variances taken as known, most of these runs would be alarms."""
    assert sum(bool(run["announced"]) for run in quiet) <= 3
    assert sum(run["family p"] < 0.05 for run in quiet) <= 4
    assert 0.3 < fmean(run["lack of fit p"] for run in quiet) < 0.7
    assert 0.4 < fmean(p for run in quiet for p in run["p"].values()) < 0.6


def test_what_is_hidden_is_named_with_its_amplitude(hit):
    assert [run["first"] for run in hit] == [run["kind"] for run in hit]
    assert all(abs(z) < 4.5 for run in hit for z in run["z"])
    assert all(run["error after"] < run["error before"] / 8 for run in hit)
    (found,) = hits.summary(hit).values()
    assert found["right effect first"]["percent"] == 100
    assert found["confused"] == []
    assert found["held-out error over that of the true structure, worst median of an effect"] == pytest.approx(1)


def test_the_seeds_do_not_depend_on_the_noise_levels_asked_for():
    assert hits.tasks(2, (0.03,)) == [task for task in hits.tasks(2) if task[1] == 0.03]
    assert len(hits.kinds()) >= 30


def test_an_effect_outside_the_library_is_called_so_and_its_shape_is_seen():
    runs = [unknown.one((kind, 0)) for kind in ("resonance", "backlash")]
    assert [run["conclusion"] for run in runs] == 2 * ["not in the library"]
    assert not any(run["confident"] for run in runs)
    assert all(run["correlation of the map"] > 0.9 and run["correlation of the response"] > 0.7 for run in runs)
    assert "not in the library" in render(pictures.unknown_page(runs, unknown.summary(runs)))


def test_two_hidden_effects_are_both_found():
    runs = [pairs.one(("drift", "quadratic_sensor", 0))]
    assert runs[0]["both found"]
    assert runs[0]["error at the noise floor"]
    errors = runs[0]["held-out errors"]
    assert errors == sorted(errors, reverse=True)
    assert "drift + quadratic_sensor" in render(pictures.pair_page(runs, pairs.summary(runs)))


def test_pages_hold_the_figures(quiet, hit):
    found = alarms.summary(quiet)
    page = render(pictures.alarm_page(quiet, found))
    assert all(name in page for name in found)
    page = render(pictures.hit_page(hit, hits.summary(hit)))
    assert all(kind in page for kind in FOUND)
    assert "https://" not in page.split("<body")[1].split("<script")[0]


def test_rates_come_with_exact_intervals():
    assert share([False] * 400)["interval"] == [0.0, pytest.approx(1.32, abs=0.01)]
    assert share([True, False])["percent"] == 50
    assert most(0.05, 400) == pytest.approx(7.75)
