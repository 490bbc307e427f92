"""Quantities of documents and of channels are the same, and units are held against them."""

from typing import get_args

import pytest

from app.conversion.channels import NAMES, UNITS, check_unit, foreign
from app.schemas.plants import SignalDescription
from app.schemas.quantities import QuantityName
from identification.channels import Channel, Channels, Quantity
from identification.errors import MisuseError


def test_every_quantity_has_a_name_and_a_unit() -> None:
    assert set(NAMES.values()) == set(get_args(QuantityName))
    assert set(UNITS) == set(get_args(Quantity))


@pytest.mark.parametrize("quantity", get_args(Quantity))
def test_its_own_unit_fits(quantity: Quantity) -> None:
    check_unit(SignalDescription(name="x", unit=UNITS[quantity], quantity=NAMES[quantity]))


@pytest.mark.parametrize(
    ("unit", "quantity"),
    [("mm", "position"), ("rpm", "angularVelocity"), ("%", "position"), ("counts", "force"), ("°C", "temperature")],
)
def test_usual_units_and_shares_fit(unit: str, quantity: QuantityName) -> None:
    check_unit(SignalDescription(name="x", unit=unit, quantity=quantity))


@pytest.mark.parametrize(
    ("unit", "quantity"), [("deg", "position"), ("mA", "voltage"), ("kN", "torque"), ("m/s", "acceleration")]
)
def test_units_of_other_quantities_do_not(unit: str, quantity: QuantityName) -> None:
    with pytest.raises(MisuseError, match=r"no unit of .* state "):
        check_unit(SignalDescription(name="x", unit=unit, quantity=quantity))


def test_an_electric_drive_may_have_both_kinds_of_effects() -> None:
    drive = Channels(Channel(quantity="voltage"), Channel(quantity="angular velocity"))
    assert not foreign("electrical", drive)
    assert not foreign("mechanical", drive)
    assert not foreign("electrical", Channels(Channel(quantity="force"), Channel()))
    assert foreign("impedance", Channels(Channel(quantity="force"), Channel(quantity="position")))
