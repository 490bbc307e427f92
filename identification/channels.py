"""What the input and the output of an experiment are: their quantities decide where physical effects act."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

from identification.errors import MisuseError

Quantity = Literal[
    "position", "velocity", "acceleration", "force",
    "angle", "angular velocity", "angular acceleration", "torque",
    "charge", "current", "voltage",
    "volume", "flow", "pressure",
    "heat", "heat flow", "temperature",
]  # fmt: skip
Domain = Literal["translation", "rotation", "electrical", "hydraulic", "thermal"]

_MOTIONS: dict[Domain, tuple[Quantity, ...]] = {
    "translation": ("position", "velocity", "acceleration"),
    "rotation": ("angle", "angular velocity", "angular acceleration"),
    "electrical": ("charge", "current"),
    "hydraulic": ("volume", "flow"),
    "thermal": ("heat", "heat flow"),
}
_EFFORTS: dict[Domain, Quantity] = {
    "translation": "force",
    "rotation": "torque",
    "electrical": "voltage",
    "hydraulic": "pressure",
    "thermal": "temperature",
}


def order_of(quantity: Quantity) -> int | None:
    """How often its domain's displacement is differentiated: 0 displacement, 1 flow, 2 its rate; None: effort."""
    return next((motions.index(quantity) for motions in _MOTIONS.values() if quantity in motions), None)


def domain_of(quantity: Quantity) -> Domain:
    """The physical domain that a quantity belongs to."""
    return next(d for d, motions in _MOTIONS.items() if quantity in motions or quantity == _EFFORTS[d])


@dataclass(frozen=True)
class Channel:
    """One measured signal: `quantity` None where it was not said, `level` about which it moves where that is stated."""

    name: str = ""
    quantity: Quantity | None = None
    unit: str = ""
    level: float | None = None

    def __post_init__(self) -> None:
        if self.quantity is not None and self.quantity not in get_args(Quantity):
            raise MisuseError(
                f"the quantity {self.quantity!r} is not known; give one of {', '.join(get_args(Quantity))}, or none",
                "quantity",
            )

    @property
    def order(self) -> int | None:
        """0 for a displacement, 1 for a flow, 2 for its rate; None for an effort and where no quantity was stated."""
        return None if self.quantity is None else order_of(self.quantity)


@dataclass(frozen=True)
class Channels:
    """What the input and the output of an experiment are."""

    input: Channel = Channel()
    output: Channel = Channel()

    def at_level(self, level: float) -> "Channels":
        """The same, both moving about this level."""
        return Channels(replace(self.input, level=level), replace(self.output, level=level))


UNSTATED = Channels()
