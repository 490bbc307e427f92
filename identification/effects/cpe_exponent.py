"""Arcs of the model that are depressed."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.models.rational import roots
from identification.models.structure import Structure
from identification.places.core import Plant, Reshaped
from identification.places.place import Flow, Setting
from identification.signals import HeldInput


@dataclass(frozen=True)
class CpeExponent(Reshaped):
    """R/(1 + (jωτ)^{1−e}) in place of R/(1 + jωτ), an arc that the model itself has: its i-th, i = `arc`.

    The partial fraction r/(x + q) of G with a real q > 0 is such an arc of R = r/q; a capacitance that is a
    constant-phase element, as of rough electrodes, depresses it [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "cpe_exponent"
    title: ClassVar[str] = "depressed arc of the model (constant-phase exponent)"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "1"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 0.6
    states: ClassVar[float] = float("inf")
    unjudged: ClassVar[str] = "the model has no arcs: it is in discrete time, or without poles"

    arc: int = 0

    def reshaped(
        self, e: FloatArray, plant: Plant, setting: Setting, omega: FloatArray, held: HeldInput | None
    ) -> ComplexArray:
        """G + R/(1 + (x/q)^{1−e}) − R/(1 + x/q), x = jω/ω₀; G where the pole is not that of an arc."""
        found = plant(setting.zeta, omega, held)
        x = 1j * omega / setting.structure.frequency_scale
        change = []
        for zeta, amount in zip(setting.zeta, e, strict=True):
            q, resistance = self._element(setting.structure, zeta)
            depressed = 1 / (1 + (x / q) ** (1 - amount)) if q > 0 else np.zeros_like(x)
            change.append(resistance * (depressed - 1 / (1 + x / q)) if q > 0 else depressed)
        return np.asarray(found + np.array(change))

    def _element(self, structure: Structure, zeta: FloatArray) -> tuple[float, float]:
        """q and R; zeros where the pole is not real and stable."""
        a, b = _polynomials(structure, zeta)
        pole = sorted(roots(a), key=abs)[self.arc]
        if abs(pole.imag) > 1e-9 * abs(pole) or pole.real >= 0:
            return 0.0, 0.0
        slope = np.polyval(np.polyder(np.concatenate([[1.0], a])), pole.real)
        return -float(pole.real), float(np.polyval(b, pole.real) / slope / -pole.real)

    def judgeable(self, flow: Flow) -> bool:
        """Only in continuous time, with poles and without a delay."""
        structure = flow.setting.structure
        letters = {name[0] for name in structure.coefficient_names[: structure.n_plant]}
        return not structure.is_discrete and letters == {"a", "b"}

    def variants(self, flow: Flow) -> list[Self]:
        """Every pole, slowest first."""
        return [replace(self, arc=i) for i in range(flow.setting.structure.order)]


def _polynomials(structure: Structure, zeta: FloatArray) -> tuple[FloatArray, FloatArray]:
    """a_1 … and b_0 … by their names."""
    letters = np.array([name[0] for name in structure.coefficient_names])
    return zeta[letters == "a"], zeta[letters == "b"]
