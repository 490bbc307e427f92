"""A(p) by least squares with all its poles in a region: a semidefinite programme [Kergus2019, Algorithm 2]."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from identification.arrays import FloatArray
from identification.parametric.conic_programme import Blocks, Misfit, minimised_misfit
from identification.parametric.equations import ShiftEquations
from identification.parametric.triangular import triangular_factor
from identification.pole_regions.inequality import PoleRegion

ROUNDS = 8
WORTH_IT = 0.99  # a round must lower the misfit by this factor to be followed by another
SLACK = 1.1  # the first problem asks for a little more margin, so that its solution starts the second one inside


@dataclass(frozen=True, eq=False)
class ConstrainedDynamics:
    """A_1 … A_J (J, n, n), how the solver ended, and what certifies the poles.

    `certificate`: the largest eigenvalue of P ⊗ I + Q ⊗ L⁻¹A(p)L + Qᵀ ⊗ (L⁻¹A(p)L)ᵀ, X = L Lᵀ, over the operating
    points at which the inequality was imposed. Below zero it proves that the poles there lie in the region.
    """

    dynamics: FloatArray
    certificate: float
    iterations: int
    solved: bool


def constrained_dynamics(
    equations: ShiftEquations,
    region: PoleRegion,
    margin: float,
    functions: FloatArray,
    misfit: Misfit,
    weight: FloatArray,
) -> ConstrainedDynamics:
    """The best A(p) with f(λ) ⪯ −margin for all its poles wherever the inequality is imposed.

        min ‖(Ψ Ã_aug − Δ_aug X) M‖   s.t.   (P + margin I) ⊗ X + Q ⊗ Ã(p) + Qᵀ ⊗ Ã(p)ᵀ ⪯ 0,   X ⪰ I,   A_j = Ã_j X⁻¹

    [Kergus2019, (21)–(24)] with X ⪰ I to fix the scale. `functions` (V, J): the basis functions of A at the operating
    points of the inequality. `misfit` "spectral" takes the largest singular value over the operating points, as (23)
    does; "frobenius" the sum of squares that the unconstrained problem (15) has. A second problem keeps this X and
    minimises ‖Ψ A_aug − Δ_aug‖ itself, without the weight X; both are repeated with the misfit of the first weighted by
    X⁻¹ of the round before, while that helps. `weight` M (n, n) says how much each direction of the state counts (the
    unconstrained solution does not depend on it). Solved in a state basis in which Σ Ω_mᵀ Ω_m = I, with A
    in units of its size and functions of the operating point that are orthonormal.
    """
    scaled = _Scaled.of(equations, functions)
    scale = float(np.linalg.norm(scaled.normalised.delta_stacked, 2)) or 1.0
    inequality = Inequality(*region.matrices, scaled.functions).scaled(scale)
    normalised = replace(scaled.normalised, delta=scaled.normalised.delta / scale)
    right = scaled.root @ weight
    found = _searched(normalised, inequality, margin / scale, misfit, right / np.linalg.norm(right, 2))
    inverse = np.asarray(solve_triangular(found.factor, np.eye(len(found.factor)), lower=True))
    certificate = np.linalg.eigvalsh(inequality.value(found.normal, np.eye(len(inverse))))[:, -1].max()
    dynamics = scaled.restored(scale * found.factor @ found.normal @ inverse)
    return ConstrainedDynamics(dynamics, scale * float(certificate), found.iterations, found.solved)


@dataclass(frozen=True, eq=False)
class _Found:
    """L⁻¹ A_j L (J, n, n) and L (n, n), with the misfit that they leave."""

    normal: FloatArray
    factor: FloatArray
    misfit: float
    iterations: int
    solved: bool


def _searched(
    equations: ShiftEquations, inequality: "Inequality", margin: float, misfit: Misfit, right: FloatArray
) -> _Found:
    """Rounds of both problems, each weighted by X⁻¹ of the one before, while they lower the misfit."""
    n = equations.order
    best = _Found(equations.dynamics(), np.eye(n), np.inf, 0, False)
    iterations = 0
    for _ in range(ROUNDS):
        joint = minimised_misfit(
            _problem(equations, best.factor, inequality.with_margin(SLACK * margin), misfit, right, True)
        )
        iterations += joint.iterations
        if not joint.solved:
            break
        factor = best.factor @ np.asarray(cholesky(joint.symmetric, lower=True))
        factor = factor / np.linalg.norm(factor, 2)
        fixed = minimised_misfit(_problem(equations, factor, inequality.with_margin(margin), misfit, right, False))
        iterations += fixed.iterations
        if not fixed.solved or fixed.misfit > WORTH_IT * best.misfit:
            break
        best = _Found(fixed.free, factor, fixed.misfit, iterations, True)
    return replace(best, iterations=iterations)


def _problem(
    equations: ShiftEquations,
    factor: FloatArray,
    inequality: "Inequality",
    misfit: Misfit,
    right: FloatArray,
    unknown_x: bool,
) -> Blocks:
    """min ‖(Ω_m L Ã(p_m) − Δ_m L X) L⁻¹ M‖ in Ã, and in X where it is unknown, else for X = I."""
    size = (equations.functions_a.shape[1], equations.order)
    turned = replace(equations, omega=equations.omega @ factor, delta=equations.delta @ factor)
    inverse = np.asarray(solve_triangular(factor, np.eye(len(factor)), lower=True))

    def residuals(a: FloatArray, x: FloatArray) -> FloatArray:
        return np.asarray(_residuals(turned, misfit, a, x) @ inverse @ right)

    return Blocks(size, misfit, residuals, inequality.value, unknown_x)


@dataclass(frozen=True, eq=False)
class Inequality:
    """P ⊗ X + Q ⊗ Ã(p) + Qᵀ ⊗ Ã(p)ᵀ at V operating points, where A's functions are `functions` (V, J)."""

    p: FloatArray
    q: FloatArray
    functions: FloatArray

    def scaled(self, unit: float) -> "Inequality":
        """The same for A measured in a unit."""
        return replace(self, p=self.p / unit)

    def with_margin(self, margin: float) -> "Inequality":
        """With P + margin I in place of P."""
        return replace(self, p=self.p + margin * np.eye(len(self.p)))

    def value(self, matrices: FloatArray, x: FloatArray) -> FloatArray:
        """The left-hand side (V, …, r n, r n) for Ã (…, J, n, n) and X (…, n, n)."""
        size = len(self.p) * x.shape[-1]
        shape = (len(self.functions), *matrices.shape[:-3], size, size)
        at_points = np.einsum("vj,...jab->v...ab", self.functions, matrices)
        from_a = np.einsum("rs,v...ab->v...rasb", self.q, at_points).reshape(shape)
        from_x = np.einsum("rs,...ab->...rasb", self.p, x).reshape(shape[1:])
        return np.asarray(from_x + from_a + np.swapaxes(from_a, -1, -2))


@dataclass(frozen=True, eq=False)
class _Scaled:
    """The equations in a state basis with Σ Ω_mᵀ Ω_m = I and with orthonormal functions of the operating point."""

    normalised: ShiftEquations
    functions: FloatArray
    root: FloatArray
    mixing: FloatArray

    @classmethod
    def of(cls, equations: ShiftEquations, functions: FloatArray) -> "_Scaled":
        root = triangular_factor(equations.omega.reshape(-1, equations.order))
        mixing = triangular_factor(np.concatenate([equations.functions_a, functions]))
        turned = equations.in_basis(np.asarray(solve_triangular(root, np.eye(len(root)))))
        own, imposed = (np.asarray(np.linalg.solve(mixing.T, f.T).T) for f in (equations.functions_a, functions))
        return cls(replace(turned, functions_a=own), imposed, root, mixing)

    def restored(self, dynamics: FloatArray) -> FloatArray:
        """A_1 … A_J in the basis and for the functions that were given."""
        mixed = np.linalg.solve(self.mixing, dynamics.reshape(len(dynamics), -1)).reshape(dynamics.shape)
        return np.asarray(np.linalg.solve(self.root, mixed @ self.root))


def _residuals(equations: ShiftEquations, misfit: Misfit, a: FloatArray, x: FloatArray) -> FloatArray:
    """Ω_m Ã(p_m) − Δ_m X of Ã (N, J, n, n), X (N, n, n), reduced to a few rows: (blocks, N, rows, n)."""
    n = equations.order
    if misfit == "spectral":
        joint = np.concatenate([equations.omega, equations.delta], axis=2)
        triangles = np.stack([triangular_factor(one) for one in joint])
        at_points = np.einsum("mj,bjac->mbac", equations.functions_a, a)
        return np.asarray(triangles[:, None, :, :n] @ at_points - triangles[:, None, :, n:] @ x)
    triangle = triangular_factor(np.hstack([equations.psi, equations.delta_stacked]))
    stacked = a.reshape(len(a), -1, n)
    return np.asarray((triangle[:, :-n] @ stacked - triangle[:, -n:] @ x)[None])
