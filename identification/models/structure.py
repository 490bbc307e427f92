"""What a model of one operating point is: coefficients ζ, and what they say of G and H."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.errors import MisuseError
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import HeldInput

NOT_ALONG = "only models in discrete time without an estimated delay are simulated along p(t)"


@dataclass(frozen=True)
class Group:
    """Coefficients that share basis functions: a single one, or all entries of a matrix; those of H come last."""

    name: str
    entries: tuple[str, ...]
    of_noise: bool = False


@dataclass(frozen=True, eq=False)
class Along:
    """The output y (N, n_y) while ζ follows p(t), and how it changes, (N, n_y), with changes dζ_G (N, n_plant)."""

    output: FloatArray
    change: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class DifferenceEquation:
    """y(t) = −Σ_{i ≤ n_a} ζ_i y(t−i) + Σ_{i ≤ n_b} ζ_{n_a+i+1} u(t−n_k−i): the orders, and T in seconds."""

    n_a: int
    n_b: int
    n_k: int
    sample_time: float


class Structure(ABC):
    """y = G u + H e at one operating point, with coefficients ζ (n,): those of G first, then those of H.

    A structure is one file with the mathematics alone; leading axes (…) of ζ are many models at once. `sample_time` in
    seconds, None for continuous time; `frequency_scale` in rad/s, where a model without data is looked at.
    """

    sample_time: float | None
    frequency_scale: float = 1.0

    @property
    @abstractmethod
    def groups(self) -> tuple[Group, ...]:
        """The coefficients in order."""

    @property
    @abstractmethod
    def order(self) -> int:
        """n_x, the number of poles."""

    def over(
        self, variables: tuple[SchedulingVariable, ...], basis: ProductBasis | None = None, **own: ProductBasis
    ) -> ParameterDependence:
        """How the coefficients depend on scheduling variables: all by `basis`, but those of a named group by its own.

        Raises MisuseError for a group that there is not, or one without a basis.
        """
        unknown = sorted(set(own) - {group.name for group in self.groups})
        if unknown:
            names = ", ".join(group.name for group in self.groups)
            raise MisuseError(f"{', '.join(unknown)} is no group of coefficients; there are {names}", unknown[0])
        bases = [own.get(group.name, basis) for group in self.groups]
        if None in bases:
            raise MisuseError("some coefficients have no basis; give one for all that have none of their own", "basis")
        entries = tuple(len(group.entries) for group in self.groups)
        return ParameterDependence(variables, tuple(one for one in bases if one is not None), entries)

    def dead_time(self, zeta: FloatArray) -> FloatArray:
        """The seconds (…,) of ζ (…, n) by which everything passes later, beside what poles and zeros do."""
        return np.zeros(zeta.shape[:-1])

    @property
    def memory(self) -> float:
        """n_x T in seconds, by which poles at zero may delay; 0 in continuous time."""
        return self.order * (self.sample_time or 0.0)

    @property
    def transients(self) -> int:
        """How many coefficients what was before a record and what follows it take at its lines, over A(q)."""
        return self.order

    @property
    def outputs(self) -> int:
        """n_y."""
        return 1

    @property
    def inputs(self) -> int:
        """n_u."""
        return 1

    @property
    def is_discrete(self) -> bool:
        """True in discrete time."""
        return self.sample_time is not None

    @cached_property
    def coefficient_names(self) -> tuple[str, ...]:
        """The names of the entries of ζ, in order."""
        return tuple(name for group in self.groups for name in group.entries)

    @cached_property
    def n_plant(self) -> int:
        """Number of coefficients of G."""
        return sum(len(group.entries) for group in self.groups if not group.of_noise)

    @cached_property
    def n_noise(self) -> int:
        """Number of coefficients of H."""
        return sum(len(group.entries) for group in self.groups if group.of_noise)

    @cached_property
    def size(self) -> int:
        """n, the number of entries of ζ."""
        return self.n_plant + self.n_noise

    @abstractmethod
    def response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """G(ω; ζ) for ζ (…, n) and ω (F,) in rad/s, as (…, F, n_y, n_u)."""

    @abstractmethod
    def gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """∂G/∂ζ_G for ζ (…, n) and ω (F,), as (…, F, n_y, n_u, n_plant)."""

    @abstractmethod
    def poles(self, zeta: FloatArray) -> ComplexArray:
        """Poles of G for ζ (…, n), as (…, n_x): in the z-plane, or in rad/s in continuous time."""

    @abstractmethod
    def pole_gradient(self, zeta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Poles (…, n_x) and their derivatives by ζ_G, (…, n_x, n_plant); infinite at poles that coincide."""

    @abstractmethod
    def along(self, zeta: FloatArray, input: FloatArray) -> Along:
        """The output from rest for u (N, n_u), ζ (N, n) following p(t) at once; numbers that grow beyond all are kept.

        Raises MisuseError where no simulation along p(t) is defined: in continuous time, or with an estimated delay.
        """

    def difference_equation(self) -> DifferenceEquation:
        """The orders of the difference equation that ζ_G are the coefficients of; raises MisuseError without one."""
        raise MisuseError("only rational models in discrete time without an estimated delay are difference equations")

    def plant_response(self, zeta: FloatArray, omega: FloatArray, held: HeldInput | None = None) -> ComplexArray:
        """G from the first input to the first output, as (…, F).

        `held`: as its samples show it in continuous time with an input held between them; the same in discrete time.
        Raises MisuseError where that is not defined.
        """
        self._require_unheld(held)
        return np.asarray(self.response(zeta, omega)[..., 0, 0])

    def plant_gradient(self, zeta: FloatArray, omega: FloatArray, held: HeldInput | None = None) -> ComplexArray:
        """∂G/∂ζ_G of `plant_response`, as (…, n_plant, F)."""
        self._require_unheld(held)
        return np.swapaxes(self.gradient(zeta, omega)[..., 0, 0, :], -1, -2)

    def channel_response(self, zeta: FloatArray, omega: FloatArray, channels: IntArray) -> ComplexArray:
        """G of ζ (M, n) from one input to one output each, `channels` (M, 2) output and input from 0, as (M, F)."""
        rows = np.arange(len(channels))
        return np.asarray(self.response(zeta, omega)[rows, :, channels[:, 0], channels[:, 1]])

    def channel_gradient(self, zeta: FloatArray, omega: FloatArray, channels: IntArray) -> ComplexArray:
        """∂G/∂ζ_G of `channel_response`, as (M, n_plant, F)."""
        rows = np.arange(len(channels))
        return np.swapaxes(self.gradient(zeta, omega)[rows, :, channels[:, 0], channels[:, 1]], 1, 2)

    def sampled(self, zeta: FloatArray, step: float) -> tuple[FloatArray, FloatArray] | None:
        """[A B; 0 1] (n_x + 1, n_x + 1) over one step of a held input, and C (n_x,), for ζ (n,); None: not known."""
        return None

    def without_direct_path(self, zeta: FloatArray) -> "tuple[Structure, FloatArray, float]":
        """The structure and ζ of G − G(∞), and G(∞); as it is where that does not say."""
        return self, zeta, 0.0

    def _require_unheld(self, held: HeldInput | None) -> None:
        if held is not None and not self.is_discrete:
            raise MisuseError("this structure in continuous time is not seen through a held input", "structure")

    def characteristic(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """A (…, 1 + m, F) for ζ (…, n): the denominator of G, then its derivatives by the first m coefficients.

        The others are not in it; 1 without derivatives where G has no such form.
        """
        return np.ones((*zeta.shape[:-1], 1, len(omega)), dtype=np.complex128)

    def noise_response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """H(ω; ζ) for ζ (…, n) and ω (F,), as (…, F); one unless overridden."""
        return np.ones((*zeta.shape[:-1], len(omega)), dtype=np.complex128)

    def noise_gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """∂H/∂ζ_H for ζ (…, n) and ω (F,), as (…, n_noise, F)."""
        return np.zeros((*zeta.shape[:-1], 0, len(omega)), dtype=np.complex128)

    def stable(self, zeta: FloatArray) -> BoolArray:
        """Whether G is stable and H stable with a stable inverse, for ζ (…, n), as (…,)."""
        if not self.is_discrete:
            return np.asarray(np.all(self.poles(zeta).real < 0, axis=-1))
        return np.asarray(self.radius(zeta) < 1)

    def radius(self, zeta: FloatArray) -> FloatArray:
        """The largest modulus of a pole, or of a zero of H, in the z-plane, for ζ (…, n), as (…,)."""
        return np.asarray(abs(self.poles(zeta)).max(axis=-1, initial=0.0))

    def gauge(self, zeta: FloatArray) -> FloatArray:
        """Directions of ζ (…, n) that no response shows, (…, n, g), none unless overridden.

        They are linear in ζ, and what changes of a group depends on this group alone.
        """
        return np.zeros((*zeta.shape, 0))
