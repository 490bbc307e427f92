from typing import get_args

import numpy as np
import pytest

from identification.channels import Channel, Channels, Quantity, domain_of, order_of
from identification.errors import MisuseError, ShapeError
from identification.signals import TimeRecord


def test_the_order_counts_the_derivatives_of_the_displacement() -> None:
    assert [order_of(one) for one in ("angle", "angular velocity", "angular acceleration", "torque")] == [0, 1, 2, None]
    assert [order_of(one) for one in ("charge", "current", "voltage")] == [0, 1, None]
    assert Channel().order is None


def test_every_quantity_has_one_domain_and_efforts_have_no_order() -> None:
    efforts = {one for one in get_args(Quantity) if order_of(one) is None}
    assert efforts == {"force", "torque", "voltage", "pressure", "temperature"}
    assert len({domain_of(one) for one in efforts}) == 5
    assert {domain_of(one) for one in ("volume", "flow", "pressure")} == {"hydraulic"}


def test_an_unknown_quantity_is_refused_with_those_there_are() -> None:
    with pytest.raises(MisuseError, match="angular velocity"):
        Channel(quantity="rpm")  # type: ignore[arg-type]


def test_a_reference_needs_feedback_and_the_length_of_the_record() -> None:
    u = np.arange(8.0)
    with pytest.raises(MisuseError, match="feedback"):
        TimeRecord(u, u, 0.1, (0.0,), reference=u)
    with pytest.raises(ShapeError, match="reference"):
        TimeRecord(u, u, 0.1, (0.0,), feedback=True, reference=u[:4])
    assert TimeRecord(u, u, 0.1, (0.0,), feedback=True, reference=u).channels == Channels()
