"""How a plant's operating points, signals and frequencies are called in tables and on axes."""

from dataclasses import dataclass

import numpy as np

from app.report.numbers import point_label
from identification.arrays import FloatArray
from identification.scheduling import SchedulingVariable
from identification.signals import OperatingPoint

FREQUENCY = "frequency (Hz)"


@dataclass(frozen=True)
class Axes:
    """The scheduling variables and the units of input and output; "" where there is none."""

    variables: tuple[SchedulingVariable, ...]
    input_name: str
    input_unit: str
    output_name: str
    output_unit: str

    def point(self, point: OperatingPoint) -> str:
        """An operating point in words."""
        return point_label(point, tuple(v.name for v in self.variables), tuple(v.unit for v in self.variables))

    @property
    def scheduling(self) -> str:
        """Label of the axis of the first scheduling variable."""
        return labelled(self.variables[0].name, self.variables[0].unit)

    @property
    def input(self) -> str:
        """Label of the input's axis."""
        return labelled(self.input_name, self.input_unit)

    @property
    def energy_unit(self) -> str:
        """Unit of Σ u²."""
        return f"{self.input_unit}²" if self.input_unit else ""

    @property
    def gain_unit(self) -> str:
        """Unit of the frequency response."""
        return f"{self.output_unit}/{self.input_unit}" if self.input_unit and self.output_unit else self.output_unit


def labelled(name: str, unit: str) -> str:
    """A quantity with its unit in brackets."""
    return f"{name} ({unit})" if unit else name


def hertz(omega: FloatArray | float) -> FloatArray:
    """Frequencies in rad/s as a reader of a report wants them, f = ω/2π."""
    return np.asarray(omega) / (2 * np.pi)
