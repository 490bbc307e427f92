"""What the demonstration claims is so."""

from dataclasses import replace

import numpy as np
import pytest

from app.demo import task
from app.demo.run import verdict
from app.demo.story import Story, energy_of_more, second_problem
from oed.design import design
from oed.spectra.fir import FirSpectra
from tests.app.demo.conftest import Told

pytestmark = pytest.mark.xdist_group("demo")


@pytest.fixture(scope="session")
def story(told: Told) -> Story:
    return told.story


def test_the_first_experiment_is_not_accurate_enough_and_both_are(story: Story) -> None:
    first = np.sqrt(np.diag(story.initial.model.covariance)) / task.ASKED
    assert first.max() > 1.2
    assert story.worst_share <= 1
    assert np.all(story.accuracy.reached <= task.ASKED)


def test_the_worst_direction_is_at_least_as_bad_as_the_worst_parameter(story: Story) -> None:
    assert story.worst_share >= np.max(story.accuracy.reached / story.accuracy.asked) - 1e-12


def test_the_design_is_certified(story: Story) -> None:
    designed = story.designed.design
    assert designed.gap <= task.TOLERANCE
    assert designed.total_energy == pytest.approx(sum(experiment.energy for experiment in designed.experiments))
    assert story.designed.history[-1][1] == pytest.approx(designed.gap, abs=1e-5)


def test_expected_and_reached_accuracy_agree(story: Story) -> None:
    np.testing.assert_allclose(story.accuracy.reached, story.accuracy.expected, rtol=0.1)


def test_the_errors_are_those_that_the_covariance_allows(story: Story) -> None:
    error = story.accuracy.error
    assert error is not None
    distance = error @ np.linalg.solve(story.final.model.covariance, error)
    assert distance < 22.46  # the 99.9 % quantile of χ²(6)
    assert distance > 0.38  # the 0.1 % quantile


def test_the_signals_have_the_designed_energy_within_the_limit(story: Story) -> None:
    for signal, experiment, record in zip(
        story.signals, story.designed.design.experiments, story.second.records, strict=True
    ):
        assert np.sum(record.input**2) == pytest.approx(experiment.energy, rel=1e-9)
        assert abs(record.input).max() <= task.AMPLITUDE_LIMIT * (1 + 1e-9)
        assert record.operating_point == experiment.operating_point
        assert signal.crest_factor < 1.5


def test_other_ways_cost_more_except_spectra_without_a_degree(story: Story) -> None:
    fir, lines, white, more = (energy for _, energy in story.designed.alternatives)
    assert lines < fir < white < more


def test_repeating_the_first_experiment_as_often_as_stated_is_just_enough(story: Story) -> None:
    times = energy_of_more(story.first, story.initial) / story.first.energy
    information = np.linalg.inv(story.initial.model.covariance)
    wanted = np.diag(((1 - task.MARGIN) * task.ASKED) ** -2.0)
    lacking = np.linalg.eigvalsh(np.outer(task.ASKED, task.ASKED) * ((1 + times) * information - wanted))[0]
    assert lacking == pytest.approx(0.0, abs=1e-6)


def test_prior_information_saves_energy(story: Story) -> None:
    problem = second_problem(story.initial, FirSpectra(task.FIR_DEGREE))
    alone = design(replace(problem, prior_information=None))
    assert alone.total_energy > 1.5 * story.designed.design.total_energy


def test_the_verdict_follows_the_numbers(story: Story) -> None:
    assert verdict(story).startswith("The model is as accurate as asked")
    worse = replace(story.final.model, covariance=4 * story.final.model.covariance)
    missed = replace(story, final=replace(story.final, model=worse))
    assert verdict(missed).startswith("The model is not yet as accurate as asked")
