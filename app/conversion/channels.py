"""What the signals of a plant measure: documents to channels, and effects and units that do not fit them."""

from typing import cast, get_args

from pydantic.alias_generators import to_camel

from app.files import units
from app.schemas.plants import PlantRequest, SignalDescription
from app.schemas.quantities import QuantityName
from identification.channels import UNSTATED, Channel, Channels, Domain, Quantity, domain_of
from identification.errors import MisuseError
from identification.places.place import Effect

NAMES = {quantity: cast(QuantityName, to_camel(quantity.replace(" ", "_"))) for quantity in get_args(Quantity)}
QUANTITIES: dict[QuantityName, Quantity] = {name: quantity for quantity, name in NAMES.items()}
UNITS: dict[Quantity, str] = {
    **{"position": "m", "velocity": "m/s", "acceleration": "m/s^2", "force": "N"},
    **{"angle": "rad", "angular velocity": "rad/s", "angular acceleration": "rad/s^2", "torque": "N*m"},
    **{"charge": "C", "current": "A", "voltage": "V", "volume": "m^3", "flow": "m^3/s", "pressure": "Pa"},
    **{"heat": "J", "heat flow": "W", "temperature": "K"},
}
FOREIGN: dict[str, tuple[Domain, ...]] = {
    "electrical": ("translation", "rotation", "hydraulic", "thermal"),
    "impedance": ("translation", "rotation", "hydraulic", "thermal"),
    "mechanical": ("thermal",),
}


def channels_of(plant: PlantRequest) -> Channels:
    """What input and output of a plant are; unstated where it has several of one of them."""
    if len(plant.inputs or ()) > 1 or len(plant.outputs or ()) > 1:
        return UNSTATED
    return Channels(
        _channel(plant.inputs[0] if plant.inputs else plant.input),
        _channel(plant.outputs[0] if plant.outputs else plant.output),
    )


def _channel(signal: SignalDescription | None) -> Channel:
    if signal is None:
        return Channel()
    return Channel(signal.name, None if signal.quantity is None else QUANTITIES[signal.quantity], signal.unit)


def check_unit(signal: SignalDescription) -> None:
    """Raises MisuseError for a known unit that is one of another quantity than was stated; a share fits all."""
    unit = units.parsed(signal.unit)
    if signal.quantity is None or unit is None or unit.dimension == units.NONE:
        return
    quantity = QUANTITIES[signal.quantity]
    wanted = units.parsed(UNITS[quantity])
    assert wanted is not None, "units of quantities are known"
    if unit.dimension in (wanted.dimension, (*wanted.dimension[:-1], 0)):
        return
    fitting = [NAMES[one] for one, text in UNITS.items() if _dimension(text) == unit.dimension]
    advice = f"state {' or '.join(fitting)}, or " if fitting else ""
    raise MisuseError(
        f"{signal.unit[:30]} is no unit of {quantity}; {advice}a unit such as {UNITS[quantity]}", "quantity"
    )


def _dimension(text: str) -> units.Dimension | None:
    unit = units.parsed(text)
    return None if unit is None else unit.dimension


def foreign(effect_domain: str, channels: Channels) -> str:
    """Why effects of a domain cannot act in a plant of these channels; empty where they can or it is not known."""
    stated = [one.quantity for one in (channels.input, channels.output)]
    known = [domain_of(one) for one in stated if one is not None]
    if len(known) < len(stated) or not set(known) <= set(FOREIGN.get(effect_domain, ())):
        return ""
    return (
        f"{effect_domain} effects do not act between {stated[0]} and {stated[1]}, which are the plant's input and"
        " output; leave them out, or state other quantities of the plant"
    )


def foreign_effect(effect: Effect, channels: Channels) -> str:
    """Why an effect cannot act in a plant of these channels; empty where it can or it is not known."""
    why = foreign(effect.domain, channels)
    return f"{effect.title}: {why}" if why else ""
