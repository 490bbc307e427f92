"""Impedances that settle: what they are at rest is what they come to at low frequencies."""

import numpy as np
import pytest

from identification.effects.cpe_arc import CpeArc
from identification.effects.rc_arc import RcArc
from identification.effects.warburg_open import WarburgOpen
from identification.effects.warburg_short import WarburgShort

OMEGA = np.array([0.0, 1e-9, 1.0, 1e6])


@pytest.mark.parametrize("effect", [RcArc(), CpeArc(), WarburgShort()], ids=lambda one: one.kind)
def test_a_resistance_is_left_at_rest(effect):
    at_rest, slow, _, fast = effect.shape(OMEGA)
    assert at_rest == 1
    assert slow == pytest.approx(1, abs=1e-5)
    assert abs(fast) < 2e-3


def test_diffusion_up_to_a_wall_stores_and_lets_nothing_pass():
    """A capacitance at low frequencies, whose pole at rest is left out; half-infinite diffusion at high ones."""
    at_rest, slow, _, fast = WarburgOpen(time=4.0).shape(OMEGA)
    assert at_rest == 0
    assert slow == pytest.approx(1 / (4e-9j), rel=1e-6)
    assert fast == pytest.approx((4e6j) ** -0.5)
