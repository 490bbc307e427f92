"""What a signal measures, by the names of the documents."""

from typing import Literal

QuantityName = Literal[
    "position", "velocity", "acceleration", "force",
    "angle", "angularVelocity", "angularAcceleration", "torque",
    "charge", "current", "voltage",
    "volume", "flow", "pressure",
    "heat", "heatFlow", "temperature",
]  # fmt: skip
