"""State-space models whose matrices depend on scheduling variables that are held still (frozen)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, ComplexArray, FloatArray, finite_floats
from identification.errors import ShapeError
from identification.models.system import MatrixSizes, StateSpace, require_matching
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable


@dataclass(frozen=True, eq=False)
class ParameterVaryingStateSpace(MatrixSizes):
    """A state-space model with matrices that are sums over functions of the scheduling variables p (s,).

        A(p) = Σ_j A_j f_j(p),  and B(p), C(p), D(p) alike                                  [Kergus2019, (2), (3)]

    `bases`: the f_j of A, B, C and D; a single basis stands for all four, and a constant one keeps a matrix constant.
    `a` (J_A, n, n), `b` (J_B, n, n_u), `c` (J_C, n_y, n), `d` (J_D, n_y, n_u) with as many matrices as the basis has
    functions; `sample_time` in seconds, None for continuous time. Raises ShapeError for sizes that do not fit.
    """

    variables: tuple[SchedulingVariable, ...]
    bases: tuple[ProductBasis, ...] | ProductBasis
    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray
    sample_time: float | None = None

    def __post_init__(self) -> None:
        bases = (self.bases,) * 4 if isinstance(self.bases, ProductBasis) else tuple(self.bases)
        object.__setattr__(self, "bases", bases)
        if len(bases) != 4:
            raise ShapeError(f"{len(bases)} bases were given; give one, or one each for A, B, C and D", "bases")
        for name, basis in zip("abcd", bases, strict=True):
            matrices = finite_floats(getattr(self, name), name)
            object.__setattr__(self, name, matrices)
            if matrices.ndim != 3 or len(matrices) != basis.size:
                raise ShapeError(
                    f"{name.upper()} has shape {matrices.shape}; give {basis.size} matrices, one per function", name
                )
        require_matching(self.a[0], self.b[0], self.c[0], self.d[0])

    @cached_property
    def dependence(self) -> ParameterDependence:
        """The dependence of A, B, C and D on the scheduling variables, in this order."""
        assert not isinstance(self.bases, ProductBasis)
        return ParameterDependence(self.variables, self.bases)

    def at(self, points: ArrayLike) -> StateSpace:
        """The systems at the operating points (M, s), as one array (M,); raises RangeError outside the range."""
        p = self.dependence.points(points)
        a, b, c, d = (
            np.tensordot(basis.evaluate(p, self.variables), matrices, axes=1)
            for basis, matrices in zip(self.dependence.bases, (self.a, self.b, self.c, self.d), strict=True)
        )
        return StateSpace(a, b, c, d, self.sample_time)

    def frequency_response(self, points: ArrayLike, omega: ArrayLike) -> ComplexArray:
        """G(p, ω) at the operating points (M, s) and ω (F,) in rad/s, as (M, F, n_y, n_u)."""
        return self.at(points).frequency_response(omega)

    def poles(self, points: ArrayLike) -> ComplexArray:
        """Poles of G at the operating points (M, s), as (M, n): in the z-plane, or in rad/s in continuous time."""
        return self.at(points).poles

    def stable(self, points: ArrayLike) -> BoolArray:
        """Whether G is stable at the operating points (M, s) held still, as (M,)."""
        return self.at(points).stable
