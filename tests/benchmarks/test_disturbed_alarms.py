"""Disturbed measurements of a plant that lacks nothing: nothing is announced, and the right answers come out."""

import numpy as np
import pytest

from benchmarks.disturbed_alarms import CONDITIONS, OMEGA, STEP, one, record, response, study


def test_the_plant_of_the_study_answers_as_its_equation_says():
    g = np.random.default_rng(0)
    u, y, noise = record(0.4, g)
    lines = np.fft.rfft(np.stack([u, y])) / len(u)
    k = 4 * np.arange(1, 62, 2)
    np.testing.assert_allclose(lines[1, k] / lines[0, k], response(0.4, OMEGA), rtol=0.05)
    assert noise == pytest.approx(0.01 * np.std(y), rel=0.1)


@pytest.mark.parametrize("condition", list(CONDITIONS))
def test_hardly_anything_is_announced_and_nothing_with_confidence(condition):
    found = [one(condition, seed) for seed in (1, 2, 3)]
    assert sum(bool(d.announced) or d.variation is not None for d in found) <= 1
    assert not any(d.confident for d in found)


def test_jitter_is_named_by_its_size_and_nothing_else_is():
    for name in CONDITIONS:
        kinds = [each.effect.kind for seed in (4, 5) for each in one(name, seed).variations]
        assert kinds == (["jitter"] * 2 if name == "jitter" else []), name
    (found,) = one("jitter", 6).variations
    assert found.size == pytest.approx(0.05 * STEP, rel=0.2)


def test_the_study_counts_what_was_announced():
    assert study(1, ["hum"])["hum"] == {"runs": 1, "announced": 0, "kinds": [], "verdicts": {"nothing missing": 1}}
