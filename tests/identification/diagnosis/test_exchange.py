"""Effects that were added one by one are looked over: an imitation is exchanged, what became needless dropped."""

import numpy as np
import pytest

from identification.diagnosis.exchange import looked_over
from identification.diagnosis.staircase import staircase
from identification.effects.cpe_arc import CpeArc
from identification.effects.inductance import Inductance
from identification.effects.library import library
from identification.effects.rc_arc import RcArc
from identification.effects.warburg import Warburg
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.models.rational import RationalStructure
from identification.places.placed import placed
from tests.identification.diagnosis.test_linear_effects import model_of, responses

CELL = model_of(RationalStructure(1, 1, frequency_scale=50.0), (0, 1, 1), [1.0, 0.02, 0.0, 0.05, 0.0])
OMEGA = 2 * np.pi * np.geomspace(0.01, 5000, 50)


def three_hidden(p, s):
    resistance = 0.01 + 0.01 * p
    return 0.02 + resistance / (1 + s / 50) + 1e-6 * s + 0.002 / np.sqrt(s) + 0.01 / (1 + 0.5 * s)


def test_an_arc_that_imitates_diffusion_is_exchanged_for_it():
    """The set that adding one by one has led to on such data; all three hidden elements are in the library."""
    data = responses(three_hidden, (0.0, 0.25, 0.5, 0.75, 1.0), 1, noise=5e-3, omega=OMEGA)
    begun = CELL.plus(placed(CpeArc(0.9, exponent=0.7), 0, 1, 0.012))
    begun = fit(begun.plus(placed(Inductance(), 0, 1, 1e-6)).plus(placed(RcArc(0.5), 0, 1, 0.005)), Rows(data))
    found = looked_over(begun, data, library("impedance"), 0, 0)
    elements = {one.effect.kind: one.coefficients[0, 0] for one in found.model.effects}
    assert elements.keys() == {"inductance", "rc_arc", "warburg"}
    assert elements["warburg"] == pytest.approx(0.002, rel=0.1)
    assert found.cost < found.rows.count < begun.cost


def test_the_staircase_ends_with_the_set_as_it_was_looked_over():
    data = responses(three_hidden, (0.0, 0.5, 1.0), 1, noise=5e-3, omega=OMEGA)
    steps = staircase(CELL, data, effects=(CpeArc(), Inductance(), RcArc(), Warburg()))
    assert sorted(one.effect.kind for one in steps[-1].model.effects) == ["inductance", "rc_arc", "warburg"]
    assert [len(step.model.effects) for step in steps] == [0, 1, 2, 3]
    errors = [step.error for step in steps]
    assert errors == sorted(errors, reverse=True)
    assert steps[-1].diagnosis.lack_of_fit.p_value > 1e-3


def test_a_needless_effect_is_dropped_and_a_set_that_is_best_is_left():
    data = responses(lambda p, s: 0.02 + 0.01 / (1 + s / 50) + 1e-6 * s, (0.0, 0.5, 1.0), 2, omega=OMEGA)
    rows = Rows(data)
    effects = (Inductance(), RcArc(), Warburg(), CpeArc())
    both = fit(CELL.plus(placed(Inductance(), 0, 1, 1e-6)).plus(placed(Warburg(), 0, 1, 1e-5)), rows)
    found = looked_over(both, data, effects, 0, 0)
    assert [one.effect.kind for one in found.model.effects] == ["inductance"]
    assert looked_over(found, data, effects, 0, 0) is None
