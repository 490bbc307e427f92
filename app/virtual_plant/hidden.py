"""What the simulated plant may hide, as equations of its own; amplitudes in N, mm and s."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray


@dataclass(frozen=True)
class Hidden:
    """Nothing hidden; what does hide something overrides one of the methods. `kind`: its name in the library;
    `unit`: that of its amplitude here.

    Forces (N) act against the motion; x is the deflection in mm, v its rate in mm/s.
    """

    kind: ClassVar[str] = "none"
    unit: ClassVar[str] = ""
    memories: ClassVar[int] = 0
    amplitude: float = 0.0

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray | float:
        """The hidden force."""
        return 0.0

    def remembered(self, v: FloatArray, memory: list[FloatArray], drive: FloatArray) -> list[FloatArray]:
        """The rates of change of what the effect remembers."""
        return []

    def played(self, drive: FloatArray, duration: float) -> FloatArray:
        """The force that arrives at the plant, for one period of it (M, n) that lasts so long."""
        return drive

    def stiffness(self, relative: FloatArray) -> FloatArray | float:
        """Further stiffness in N/mm at positions −1 … 1 of the range."""
        return 0.0

    def beside(self, memory: list[FloatArray]) -> FloatArray | float:
        """Further deflection beside that of the first mode, in mm."""
        return 0.0


@dataclass(frozen=True)
class CubicStiffness(Hidden):
    """A spring that hardens, in N/mm³."""

    kind: ClassVar[str] = "cubic_stiffness"
    unit: ClassVar[str] = "N/mm³"
    amplitude: float = 0.004

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray:
        return self.amplitude * x * x * x


@dataclass(frozen=True)
class QuadraticStiffness(Hidden):
    """A spring that is stiffer in one direction, in N/mm²."""

    kind: ClassVar[str] = "quadratic_stiffness"
    unit: ClassVar[str] = "N/mm²"
    amplitude: float = 0.02

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray:
        return self.amplitude * x * x


@dataclass(frozen=True)
class QuadraticDamping(Hidden):
    """Drag, in N/(mm/s)²."""

    kind: ClassVar[str] = "quadratic_damping"
    unit: ClassVar[str] = "N/(mm/s)²"
    amplitude: float = 4e-6

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray:
        return self.amplitude * abs(v) * v


@dataclass(frozen=True)
class DryFriction(Hidden):
    """Coulomb friction, in N."""

    kind: ClassVar[str] = "coulomb_friction"
    unit: ClassVar[str] = "N"
    amplitude: float = 0.4

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray:
        return self.amplitude * np.tanh(v / 0.5)


@dataclass(frozen=True)
class Stop(Hidden):
    """A further spring in N/mm beyond `gap` mm."""

    kind: ClassVar[str] = "dead_band_spring"
    unit: ClassVar[str] = "N/mm"
    amplitude: float = 0.5
    gap: float = 3.0

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray:
        return np.asarray(self.amplitude * (x - np.clip(x, -self.gap, self.gap)))


@dataclass(frozen=True)
class SlidingBristles(Hidden):
    """Hysteresis in N: bristles that follow the motion and slide after `travel` mm."""

    kind: ClassVar[str] = "hysteresis"
    unit: ClassVar[str] = "N"
    memories: ClassVar[int] = 1
    amplitude: float = 0.6
    travel: float = 1.0

    def force(self, x: FloatArray, v: FloatArray, memory: list[FloatArray]) -> FloatArray:
        return self.amplitude * memory[0]

    def remembered(self, v: FloatArray, memory: list[FloatArray], drive: FloatArray) -> list[FloatArray]:
        return [(v - abs(v) * memory[0]) / self.travel]


@dataclass(frozen=True)
class LateForce(Hidden):
    """A delay between command and force, in s."""

    kind: ClassVar[str] = "delay"
    unit: ClassVar[str] = "s"
    amplitude: float = 8e-4

    def played(self, drive: FloatArray, duration: float) -> FloatArray:
        count = drive.shape[1]
        spectra = np.fft.rfft(drive)
        turned = np.exp(-2j * np.pi * np.arange(spectra.shape[1]) * self.amplitude / duration)
        return np.asarray(np.fft.irfft(spectra * turned, n=count))


@dataclass(frozen=True)
class WeakAmplifier(Hidden):
    """Saturation of the force: beyond `limit` N nothing is added."""

    kind: ClassVar[str] = "saturation"
    unit: ClassVar[str] = "1"
    amplitude: float = 1.0
    limit: float = 18.0

    def played(self, drive: FloatArray, duration: float) -> FloatArray:
        return np.asarray(np.clip(drive, -self.limit, self.limit))


@dataclass(frozen=True)
class LazyAmplifier(Hidden):
    """A dead zone of the force: of the first `width` N the share `amplitude` is lost."""

    kind: ClassVar[str] = "dead_zone"
    unit: ClassVar[str] = "1"
    amplitude: float = 0.5
    width: float = 1.5

    def played(self, drive: FloatArray, duration: float) -> FloatArray:
        return np.asarray(drive - self.amplitude * np.clip(drive, -self.width, self.width))


@dataclass(frozen=True)
class SecondMode(Hidden):
    """One more mode of vibration beside the first, of modal constant `amplitude` in mm/s² per N."""

    kind: ClassVar[str] = "resonance"
    unit: ClassVar[str] = "mm/(N s²)"
    memories: ClassVar[int] = 2
    amplitude: float = 20.0
    frequency: float = 110.0
    damping: float = 0.03

    def remembered(self, v: FloatArray, memory: list[FloatArray], drive: FloatArray) -> list[FloatArray]:
        place, rate = memory
        return [rate, drive - 2 * self.damping * self.frequency * rate - self.frequency**2 * place]

    def beside(self, memory: list[FloatArray]) -> FloatArray:
        return self.amplitude * memory[0]


@dataclass(frozen=True)
class SaggingScrew(Hidden):
    """Stiffness in N/mm that sags in the middle of the range: quadratic in the position, where the model is affine."""

    kind: ClassVar[str] = "quadratic_dependence"
    unit: ClassVar[str] = "N/mm"
    amplitude: float = 0.25

    def stiffness(self, relative: FloatArray) -> FloatArray:
        return self.amplitude * (1.5 * relative**2 - 0.5)


EFFECTS: Mapping[str, Hidden] = {
    one.kind: one
    for one in (
        CubicStiffness(),
        QuadraticStiffness(),
        QuadraticDamping(),
        DryFriction(),
        Stop(),
        SlidingBristles(),
        LateForce(),
        WeakAmplifier(),
        LazyAmplifier(),
        SecondMode(),
        SaggingScrew(),
    )
}
