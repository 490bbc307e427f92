"""Weights where the size of the noise is not known: what smooth residuals are worth, and which effect stands first."""

import dataclasses

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.diagnosis.evidence import effective_count, indistinguishable, overlap
from identification.diagnosis.staircase import staircase
from identification.effects.library import library
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse
from tests.support.oscillators import DEPENDENCE

OMEGA = np.geomspace(0.1, 100.0, 80)
POINTS = (-1.0, 0.0, 1.0)


def rows(variance=None, points=POINTS):
    responses = [FrequencyResponse(OMEGA, np.ones(80) + 0j, (p,), variance=variance) for p in points]
    return Rows(gather(responses))


def test_white_residuals_count_nearly_all_and_smooth_ones_few():
    white = np.random.default_rng(0).standard_normal(480)
    assert effective_count(rows(), white) > 0.8 * 480
    smooth = np.tile(np.sin(np.linspace(0, 3, 80)), 6)
    assert effective_count(rows(), smooth) == pytest.approx(2.0, abs=1.0)


def test_copies_at_other_operating_points_count_once():
    one = np.random.default_rng(1).standard_normal((1, 2, 80))
    alone = effective_count(rows(points=(0.0,)), one.ravel())
    assert effective_count(rows(), np.repeat(one, 3, axis=0).ravel()) == pytest.approx(alone, rel=1e-9)


def test_a_known_size_of_the_noise_counts_every_row():
    known = rows(np.full(80, 1e-4))
    assert effective_count(known, np.tile(np.sin(np.linspace(0, 3, 80)), 6)) == known.count


@pytest.fixture(scope="module")
def depressed():
    """Two arcs, the second slightly depressed: an RC arc and a constant-phase arc leave nearly the same."""
    impedance = 1 + 2 / (1 + 1j * OMEGA) + 1 / (1 + (0.03j * OMEGA) ** 0.93)
    structure = RationalStructure(1, 1)
    theta = np.array([1.0, 2.0, 0.0, 4.0])
    model = Model(structure, DEPENDENCE, theta, np.eye(4), 1.0)
    data = gather([FrequencyResponse(OMEGA, impedance * (1 + 1e-2 * np.sin(3 * np.log(OMEGA))), (0.5,))])
    (step, *_) = staircase(model, data, effects=library("impedance"), largest=1)
    return step.diagnosis


def test_the_simplest_of_those_that_fit_alike_stands_first(depressed):
    kinds = [one.score.candidate.effect.kind for one in depressed.announced]
    assert kinds[0] == "rc_arc"
    assert "cpe_arc" in kinds
    assert depressed.announced[0].bic <= depressed.evidence[0].bic + 2
    assert all(one.bic <= depressed.evidence[0].bic + 6 for one in depressed.announced)


def test_a_clear_difference_outweighs_simplicity(depressed):
    worse = [
        dataclasses.replace(one, bic=one.bic + (10 if one.score.candidate.effect.kind == "rc_arc" else 0))
        for one in depressed.evidence
    ]
    ordered = sorted(worse, key=lambda one: one.bic)
    assert "rc_arc" not in [one.score.candidate.effect.kind for one in indistinguishable(ordered)]


def test_what_has_another_shape_is_no_alternative(depressed):
    """It may be missing as well, but not instead, however little the effective number tells them apart."""
    close = [
        dataclasses.replace(one, bic=depressed.evidence[0].bic + 0.1 * i) for i, one in enumerate(depressed.evidence)
    ]
    kept = indistinguishable(close)
    assert all(overlap(one, close[0]) > 0.5 for one in kept)
    assert any(overlap(one, close[0]) <= 0.5 for one in close)
    assert len(kept) < len(close)
