"""What the demonstration claims is so."""

import io
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from app.conversion.models import kept_model
from app.demo import task
from app.demo.run import STEPS, tell, verdict
from app.demo.story import Story, design_request
from app.demo.terminal import Terminal
from app.jobs.tasks.design import stated_problem
from app.offline.workplace import workplace
from oed.design import design
from tests.app.demo.conftest import Told

pytestmark = pytest.mark.xdist_group("demo")


@pytest.fixture(scope="session")
def story(told: Told) -> Story:
    return told.story


def test_the_first_experiment_is_not_accurate_enough_and_the_last_model_is(story: Story) -> None:
    assert np.max(np.array(story.versions[0].standard_deviations) / task.ASKED) > 1.5
    assert np.all(story.accuracy(story.versions[-1]).reached <= task.ASKED)


def test_the_design_is_certified_and_other_ways_cost_more(story: Story) -> None:
    designed = story.designed
    assert designed.design.gap is not None
    assert designed.design.gap <= task.TOLERANCE
    own, white, more = (energy for _, energy in designed.alternatives)
    assert own == designed.design.total_energy
    assert 3 * own < min(white, more)


def test_repeating_the_first_experiment_as_often_as_stated_is_just_enough(story: Story) -> None:
    first = kept_model(story.versions[0], story.loop.plant)
    arrays = [story.loop.place.arrays.get(digest)["input"] for one, digest in story.loop.experiments[:3]]
    times = story.designed.alternatives[2][1] / sum(float(u @ u) for u in arrays)
    sigma = (1 - task.MARGIN) * task.ASKED
    information = (1 + times) * np.linalg.inv(first.covariance)
    lacking = np.linalg.eigvalsh(np.outer(sigma, sigma) * information - np.eye(4))[0]
    assert lacking == pytest.approx(0.0, abs=1e-6)


def test_prior_information_saves_energy(story: Story) -> None:
    first = kept_model(story.versions[0], story.loop.plant)
    problem = stated_problem(design_request(story.versions[0]), first, True)
    alone = design(replace(problem, prior_information=None))
    assert alone.total_energy > 1.02 * (story.designed.design.total_energy or 0.0)


def test_what_was_played_has_the_designed_energy_at_the_designed_positions(story: Story) -> None:
    played = story.designed.played
    pairs = zip(story.designed.design.experiments, played.realised(), strict=True)
    assert all(signal.energy == pytest.approx(experiment.energy) for experiment, signal in pairs)
    points = {one.operating_point[0] for one, _ in story.loop.experiments[3:5] if one.operating_point}
    assert points == {one.operating_point[0] for one in story.designed.design.experiments}


def test_the_failure_shows_the_right_effect_is_found_and_the_error_falls_to_the_noise(story: Story) -> None:
    fitted, held_out = story.compared[0].document.parts
    assert fitted.lack_of_fit is not None
    assert held_out.lack_of_fit is not None
    assert max(fitted.lack_of_fit.p_value or 0.0, held_out.lack_of_fit.p_value or 0.0) < 1e-9
    assert story.diagnosed[0].announced == ["cubic_stiffness"]
    assert story.found == [story.hidden]
    before, after = story.chain.steps()
    assert before.held_out is not None
    assert after.held_out is not None
    noise = 0.05 / np.sqrt(task.PERIODS) * np.sqrt(2 * 75 / task.PERIOD)
    outputs = [story.loop.place.arrays.get(digest)["output"] for _, digest in story.loop.others]
    size = np.sqrt(np.mean(np.concatenate(outputs) ** 2))
    assert after.held_out == pytest.approx(noise / size, rel=0.1)
    assert before.held_out > 8 * after.held_out


def test_the_errors_are_many_deviations_before_and_few_after(story: Story) -> None:
    before, after = (story.accuracy(model) for model in (story.versions[1], story.versions[-1]))
    assert before.error is not None
    assert after.error is not None
    assert np.max(abs(before.error) / before.reached) > 20
    assert np.max(abs(after.error) / after.reached) < 4


def test_the_verdict_follows_the_numbers(story: Story) -> None:
    assert "which is what the plant hides" in verdict(story)
    assert "while the plant hides delay" in verdict(replace(story, hidden="delay"))


def test_with_nothing_hidden_nothing_is_added() -> None:
    with workplace(Console(quiet=True)) as place:
        told = tell(2, Terminal(Console(file=io.StringIO()), STEPS), place, "none")
        assert told.found == []
        assert verdict(told).startswith("Nothing was found missing")
