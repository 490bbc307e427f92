"""Scheduling variables, and how the coefficients of a model depend on them: ζ(p) = T(p) θ [Ghosh2018, (2), (3)]."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray, IntArray, finite_floats
from identification.errors import RangeError, ShapeError, TooFewOperatingPointsError

Numbers = TypeVar("Numbers", FloatArray, ComplexArray)


@dataclass(frozen=True)
class SchedulingVariable:
    """A quantity that the dynamics depend on and that can be held still: its name, unit and range."""

    name: str
    unit: str
    minimum: float
    maximum: float

    def __post_init__(self) -> None:
        if not (np.isfinite([self.minimum, self.maximum]).all() and self.minimum < self.maximum):
            raise RangeError(
                f"{self.name}: the minimum {self.minimum} must lie below the maximum {self.maximum}", "maximum"
            )


class OneVariableBasis(Protocol):
    """Functions of one scheduling variable: what the plug-ins of `identification.bases` are."""

    @property
    def size(self) -> int:
        """Number of functions."""

    def evaluate(self, p: FloatArray, minimum: float, maximum: float) -> FloatArray:
        """The functions at p (M,), as (M, size)."""


@dataclass(frozen=True)
class ProductBasis:
    """Products of one-variable functions, f_j(p) = Π_s f_{j_s}(p_s).

    With `total_degree` None all combinations are taken (tensor product); otherwise those with Σ_s j_s ≤ total_degree.
    """

    factors: tuple[OneVariableBasis, ...]
    total_degree: int | None = None

    @cached_property
    def _combinations(self) -> IntArray:
        every = product(*(range(factor.size) for factor in self.factors))
        kept = [j for j in every if self.total_degree is None or sum(j) <= self.total_degree]
        return np.array(kept, dtype=np.int64).reshape(len(kept), len(self.factors))

    @property
    def size(self) -> int:
        """Number of functions."""
        return len(self._combinations)

    @property
    def labels(self) -> tuple[str, ...]:
        """One label a function: its index in each factor."""
        return tuple(",".join(map(str, j)) for j in self._combinations)

    def evaluate(self, points: FloatArray, variables: Sequence[SchedulingVariable]) -> FloatArray:
        """The functions at the operating points (M, s), as (M, size)."""
        result = np.ones((len(points), self.size))
        for s, (factor, variable) in enumerate(zip(self.factors, variables, strict=True)):
            result *= factor.evaluate(points[:, s], variable.minimum, variable.maximum)[:, self._combinations[:, s]]
        return result


@dataclass(frozen=True)
class ParameterDependence:
    """How n coefficients depend on s scheduling variables, each group of them with its own basis.

        ζ_i(p) = Σ_j θ_{g,j,i} f_{g,j}(p) for i in group g,   ζ(p) = T(p) θ,   T(p): n × k      [Ghosh2018, (2), (3)]

    A group is one coefficient, or all entries of a matrix: `entries` counts the coefficients of each, none given: one.
    θ is ordered by group, function and entry: for groups of one, (θ_{1,0}, θ_{1,1}, …, θ_{n,·}).
    """

    variables: tuple[SchedulingVariable, ...]
    bases: tuple[ProductBasis, ...]
    entries: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.entries and len(self.entries) != len(self.bases):
            raise ShapeError(f"{len(self.bases)} bases were given for {len(self.entries)} groups", "entries")
        for basis in self.bases:
            if len(basis.factors) != len(self.variables):
                raise ShapeError(
                    f"a basis has {len(basis.factors)} factors for {len(self.variables)} scheduling variables;"
                    " give one factor per variable",
                    "basis",
                )

    @property
    def size(self) -> int:
        """k, the number of entries of θ."""
        return self.parameters_of(self.coefficient_count)

    @property
    def coefficient_count(self) -> int:
        """n, the number of entries of ζ."""
        return sum(self.counts)

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of coefficients of each group."""
        return self.entries or (1,) * len(self.bases)

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of basis functions of each group."""
        return tuple(basis.size for basis in self.bases)

    @property
    def places(self) -> tuple[slice, ...]:
        """Where the coefficients of each group stand in ζ."""
        ends = np.cumsum(self.counts).tolist()
        return tuple(slice(end - count, end) for end, count in zip(ends, self.counts, strict=True))

    def split(self, theta: FloatArray) -> list[FloatArray]:
        """θ (k,) by group, each (functions, coefficients)."""
        counts = np.array(self.counts)
        parts = np.split(theta, np.cumsum(np.array(self.sizes) * counts)[:-1])
        return [part.reshape(-1, count) for part, count in zip(parts, counts, strict=True)]

    def parameters_of(self, coefficients: int) -> int:
        """How many entries of θ the first coefficients, whole groups of them, have."""
        sizes = zip(self.bases, self.counts, self.places, strict=True)
        return sum(basis.size * count for basis, count, place in sizes if place.stop <= coefficients)

    @property
    def needed_operating_points(self) -> int:
        """The least number of distinct operating points that determines θ, n_p + 1 in [Ghosh2018, Theorem 1]."""
        return max(self.sizes)

    def parameter_names(self, coefficient_names: Sequence[str]) -> tuple[str, ...]:
        """A name for each entry of θ, such as a1[0], a1[1], b0[0]."""
        pairs = zip((coefficient_names[place] for place in self.places), self.bases, strict=True)
        return tuple(f"{name}[{label}]" for names, basis in pairs for label in basis.labels for name in names)

    def points(self, points: ArrayLike) -> FloatArray:
        """Operating points as (M, s); raises ShapeError or RangeError when they do not fit the variables."""
        array = finite_floats(points, "operating_points")
        if array.ndim != 2 or array.shape[1] != len(self.variables):
            raise ShapeError(
                f"operating points have shape {array.shape}; give M rows of {len(self.variables)} values",
                "operating_points",
            )
        for s, variable in enumerate(self.variables):
            slack = 1e-9 * (variable.maximum - variable.minimum)
            outside = (array[:, s] < variable.minimum - slack) | (array[:, s] > variable.maximum + slack)
            if outside.any():
                raise RangeError(
                    f"{variable.name} = {array[outside, s][0]:g} {variable.unit} lies outside its range"
                    f" [{variable.minimum:g}, {variable.maximum:g}]; move the operating point or widen the range",
                    "operating_points",
                )
        return array

    def coefficients(self, theta: FloatArray, points: ArrayLike) -> FloatArray:
        """ζ(p) = T(p) θ at the operating points (M, s) for θ (k,), as (M, n)."""
        p, start = self.points(points), 0
        zeta = np.empty((len(p), self.coefficient_count))
        for functions, place in self._groups(p):
            stop = start + functions.shape[1] * (place.stop - place.start)
            zeta[:, place] = functions @ theta[start:stop].reshape(functions.shape[1], -1)
            start = stop
        return zeta

    def pulled(self, by_zeta: Numbers, points: ArrayLike) -> Numbers:
        """Derivatives by ζ (M, …, n) as those by θ, by_zeta T(p), (M, …, k); of the first coefficients alone if fewer.

        T(p), nearly all zeros, is not formed. Each parameter's derivatives lie together in memory.
        """
        p, start, given = self.points(points), 0, by_zeta.shape[-1]
        by_theta = np.empty((self.parameters_of(given), *by_zeta.shape[:-1]), dtype=by_zeta.dtype)
        for functions, place in self._groups(p):
            part = by_zeta[..., place]
            for values in functions.T if place.stop <= given else ():
                spread = values.reshape(-1, *(1,) * (by_zeta.ndim - 1))
                stop = start + part.shape[-1]
                np.multiply(part, spread, out=np.moveaxis(by_theta[start:stop], 0, -1))
                start = stop
        return np.moveaxis(by_theta, 0, -1)

    def _groups(self, p: FloatArray) -> Iterator[tuple[FloatArray, slice]]:
        """The functions (M, J) of each group at checked points, and where its coefficients stand in ζ."""
        values = {basis: basis.evaluate(p, self.variables) for basis in dict.fromkeys(self.bases)}
        return zip((values[basis] for basis in self.bases), self.places, strict=True)

    def matrix(self, points: ArrayLike) -> FloatArray:
        """T(p) at the operating points (M, s), as (M, n, k): for fits over a few points, not along p(t)."""
        n = self.coefficient_count
        unit = np.broadcast_to(np.eye(n), (len(np.asarray(points)), n, n))
        return self.pulled(unit, points)

    def require_identifiable(self, points: ArrayLike) -> None:
        """Raises TooFewOperatingPointsError unless the stacked T(p_m) has full column rank [Ghosh2018, Remark 2]."""
        distinct = np.unique(self.points(points), axis=0)
        for basis in dict.fromkeys(self.bases):
            values = basis.evaluate(distinct, self.variables)
            norms = np.linalg.norm(values, axis=0)
            rank = np.linalg.matrix_rank(values / np.where(norms > 0, norms, 1.0))
            if rank < basis.size:
                placed = " (enough points, but placed so that some basis functions cannot be told apart)"
                raise TooFewOperatingPointsError(
                    self.needed_operating_points, len(distinct), placed if len(distinct) >= basis.size else ""
                )
