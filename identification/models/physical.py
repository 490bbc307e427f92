"""Rational models whose coefficients are those of physics, such as inertia, damping, resistance and inductance."""

from dataclasses import dataclass
from functools import cached_property
from typing import NoReturn

import numpy as np

from identification.arrays import ComplexArray, FloatArray, require_positive
from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.rational import RationalStructure
from identification.models.structure import NOT_ALONG, Group, Structure
from identification.signals import HeldInput

LARGEST = 1e100


@dataclass(frozen=True)
class Coefficient:
    """One coefficient of A or B; `fixed` at a value in its unit, or free (None)."""

    name: str
    unit: str = ""
    fixed: float | None = None


@dataclass(frozen=True)
class PhysicalForm(Structure):
    """G = e^{−jωτ} B/A in continuous time, any one coefficient fixed in place of the leading one of A.

        A = Σ_i a_i s^{n_a − i},   B = Σ_j b_j s^{n_b − j},   s = jω,   one of all a_i, b_j ≠ 0 known

    `denominator` (n_a + 1) and `numerator` (n_b + 1) name the coefficients, that of the highest derivative first. For a
    motor J(p) ω̇ + d ω = k u they are (J, d) and (k): J linear in p is one linear coefficient here, where the form with
    a leading one has d/J and k/J. ζ holds the free coefficients in order, then τ in seconds with `delay`.

    The coefficients of the `plain` form are a_i/a_0 and b_j/a_0 in units of ω₀ = `frequency_scale`. Raises RangeError
    unless exactly one coefficient is fixed, at a value other than zero, and every one has a name of its own.
    """

    denominator: tuple[Coefficient, ...]
    numerator: tuple[Coefficient, ...]
    frequency_scale: float = 1.0
    delay: bool = False
    sample_time: None = None

    def __post_init__(self) -> None:
        if not self.denominator or not self.numerator:
            raise ShapeError("numerator and denominator need a coefficient each", "structure")
        require_positive(self.frequency_scale, "frequency scale")
        names = [one.name for one in self.all_coefficients]
        if len({*names, "tau"}) <= len(names):
            raise RangeError("every coefficient needs a name of its own, and tau is the delay's", "structure")
        fixed = [one.fixed for one in self.all_coefficients if one.fixed is not None]
        if len(fixed) != 1 or not 1 / LARGEST < abs(fixed[0]) < LARGEST:
            raise RangeError(
                "only ratios of coefficients show in a response: fix exactly one of them, at a value other than zero",
                "structure",
            )

    @property
    def all_coefficients(self) -> tuple[Coefficient, ...]:
        """Those of A, then those of B."""
        return (*self.denominator, *self.numerator)

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """Each free coefficient by itself, and tau."""
        free = (one.name for one in self.all_coefficients if one.fixed is None)
        return tuple(Group(name, (name,)) for name in (*free, *(["tau"] if self.delay else [])))

    @property
    def n_a(self) -> int:
        """Order of A."""
        return len(self.denominator) - 1

    @property
    def n_b(self) -> int:
        """Order of B."""
        return len(self.numerator) - 1

    @property
    def order(self) -> int:
        """n_a."""
        return self.n_a

    def dead_time(self, zeta: FloatArray) -> FloatArray:
        """τ."""
        return np.asarray(zeta[..., -1]) if self.delay else np.zeros(zeta.shape[:-1])

    @cached_property
    def plain(self) -> RationalStructure:
        """The same model with a leading one."""
        return RationalStructure(self.n_a, self.n_b, frequency_scale=self.frequency_scale, delay=self.delay)

    @cached_property
    def _fixed(self) -> int:
        return next(i for i, one in enumerate(self.all_coefficients) if one.fixed is not None)

    @cached_property
    def _known(self) -> float:
        return next(one.fixed for one in self.all_coefficients if one.fixed is not None)

    @cached_property
    def _scales(self) -> FloatArray:
        """ω₀ to the power of s that belongs to each of all coefficients."""
        powers = [*range(self.n_a, -1, -1), *range(self.n_b, -1, -1)]
        return np.asarray(self.frequency_scale ** np.array(powers, dtype=np.float64))

    def to_plain(self, zeta: FloatArray) -> FloatArray:
        """ζ (…, n) of the `plain` form; not finite where the coefficient of the highest derivative vanishes."""
        every = self._all(zeta)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.concatenate([every[..., 1:] / every[..., :1], zeta[..., self._count :]], axis=-1))

    def of_plain(self, plain: FloatArray) -> FloatArray:
        """ζ (…, n) of these coefficients from that of the `plain` form, the inverse of `to_plain`."""
        ratios = np.insert(plain[..., : self._count], 0, 1.0, axis=-1) / self._scales
        with np.errstate(divide="ignore", invalid="ignore"):
            every = ratios * (self._known / ratios[..., self._fixed, None])
        return np.concatenate([np.delete(every, self._fixed, axis=-1), plain[..., self._count :]], axis=-1)

    def plain_gradient(self, zeta: FloatArray) -> FloatArray:
        """∂(plain ζ)/∂ζ, (…, n, n): with x_k = c_k s_k/(c_0 s_0), ∂x_k/∂c_k = s_k/(c_0 s_0), ∂x_k/∂c_0 = −x_k/c_0."""
        every = self._all(zeta)
        count, n = self._count, self.size
        full = np.zeros((*zeta.shape[:-1], n, count + 1))
        ratios = every[..., 1:] / every[..., :1]
        full[..., np.arange(count), np.arange(1, count + 1)] = self._scales[1:] / every[..., :1]
        full[..., :count, 0] = -ratios * self._scales[0] / every[..., :1]
        of_tau = np.eye(n)[:, count:] + np.zeros((*zeta.shape[:-1], 1, 1))
        return np.concatenate([np.delete(full, self._fixed, axis=-1), of_tau], axis=-1)

    def covariance_of_plain(self, zeta: FloatArray, covariance: FloatArray) -> FloatArray:
        """That of ζ (n, n) from that of the `plain` form, to first order; infinite where either is."""
        gradient = self.plain_gradient(zeta)
        if not (np.all(np.isfinite(covariance)) and np.all(np.isfinite(gradient))):
            return np.full_like(covariance, np.inf)
        inverse = np.linalg.pinv(gradient)
        return np.asarray(inverse @ covariance @ inverse.T)

    @property
    def _count(self) -> int:
        """The number of free coefficients of A and B."""
        return len(self.all_coefficients) - 1

    def _all(self, zeta: FloatArray) -> FloatArray:
        """All coefficients (…, n_a + n_b + 2), in units of ω₀."""
        if zeta.shape[-1] != self.size:
            raise ShapeError(f"ζ has {zeta.shape[-1]} entries, this structure has {self.size}", "zeta")
        every = np.insert(zeta[..., : self._count], self._fixed, self._known, axis=-1)
        return np.asarray(every * self._scales)

    def without_direct_path(self, zeta: FloatArray) -> tuple[Structure, FloatArray, float]:
        """That of the `plain` form."""
        return self.plain.without_direct_path(self.to_plain(zeta))

    def sampled(self, zeta: FloatArray, step: float) -> tuple[FloatArray, FloatArray] | None:
        """That of the `plain` form."""
        plain = self.to_plain(zeta)
        return self.plain.sampled(plain, step) if np.all(np.isfinite(plain)) else None

    def affine(self, omega: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray, ComplexArray]:
        """A_0 (F,), ∂A (n, F), B_0 (F,), ∂B (n, F) of A = A_0 + ζᵀ∂A, B = B_0 + ζᵀ∂B, without the delay."""
        s = 1j * omega
        a = np.concatenate([s ** np.arange(self.n_a, -1, -1)[:, None], np.zeros((self.n_b + 1, len(omega)))])
        b = np.concatenate([np.zeros((self.n_a + 1, len(omega))), s ** np.arange(self.n_b, -1, -1)[:, None]])
        known = self._known
        free = np.arange(self._count + 1) != self._fixed
        return known * a[self._fixed], a[free], known * b[self._fixed], b[free]

    def characteristic(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """A (…, 1 + m, F) and its derivatives by the m free ones of its coefficients, which come first."""
        known, by_zeta, _, _ = self.affine(omega)
        free = sum(one.fixed is None for one in self.denominator)
        value = known + zeta[..., : self._count] @ by_zeta
        slopes = np.broadcast_to(by_zeta[:free], (*value.shape[:-1], free, len(omega)))
        return np.concatenate([value[..., None, :], slopes], axis=-2)

    def response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """That of one input and output, as (…, F, 1, 1)."""
        return self.plant_response(zeta, omega)[..., None, None]

    def gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """That of one input and output, as (…, F, 1, 1, n)."""
        return np.swapaxes(self.plant_gradient(zeta, omega), -1, -2)[..., None, None, :]

    def plant_response(self, zeta: FloatArray, omega: FloatArray, held: HeldInput | None = None) -> ComplexArray:
        """G(ω; ζ) for ζ (…, n) and ω (F,) in rad/s, as (…, F)."""
        return self.plain.plant_response(self.to_plain(zeta), omega, held)

    def plant_gradient(self, zeta: FloatArray, omega: FloatArray, held: HeldInput | None = None) -> ComplexArray:
        """∂G/∂ζ for ζ (…, n) and ω (F,), as (…, n, F)."""
        inner = self.plain.plant_gradient(self.to_plain(zeta), omega, held)
        return np.asarray(np.swapaxes(self.plain_gradient(zeta), -1, -2) @ inner)

    def poles(self, zeta: FloatArray) -> ComplexArray:
        """Zeros of A in rad/s for ζ (…, n), as (…, n_a)."""
        return self.plain.poles(self.to_plain(zeta))

    def pole_gradient(self, zeta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Poles (…, n_a) and their derivatives by ζ, (…, n_a, n)."""
        poles, gradient = self.plain.pole_gradient(self.to_plain(zeta))
        return poles, np.asarray(gradient @ self.plain_gradient(zeta))

    def along(self, zeta: FloatArray, input: FloatArray) -> NoReturn:
        """Refused: in continuous time."""
        raise MisuseError(NOT_ALONG, "model")


RationalForm = RationalStructure | PhysicalForm
