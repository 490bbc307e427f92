"""A(p) by least squares with all its poles in a region: a semidefinite programme [Kergus2019, Algorithm 2]."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from identification.arrays import FloatArray
from identification.parametric.conic_programme import Blocks, ConicSolution, Misfit, minimised_misfit
from identification.parametric.equations import ShiftEquations
from identification.parametric.triangular import triangular_factor
from identification.pole_regions.inequality import PoleRegion

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
    equations: ShiftEquations, region: PoleRegion, margin: float, functions: FloatArray, misfit: Misfit
) -> ConstrainedDynamics:
    """The best A(p) with f(λ) ⪯ −margin for all its poles wherever the inequality is imposed.

        min ‖Ψ Ã_aug − Δ_aug X‖   s.t.   (P + margin I) ⊗ X + Q ⊗ Ã(p) + Qᵀ ⊗ Ã(p)ᵀ ⪯ 0,   X ⪰ I,   A_j = Ã_j X⁻¹

    [Kergus2019, (21)–(24)] with X ⪰ I to fix the scale. `functions` (V, J): the basis functions of A at the operating
    points of the inequality. `misfit` "spectral" takes the largest singular value over the operating points, as (23)
    does; "frobenius" the sum of squares that the unconstrained problem (15) has. A second problem keeps this X and
    minimises ‖Ψ A_aug − Δ_aug‖ itself, without the weight X. Solved in a state basis in which Σ Ω_mᵀ Ω_m = I, with A
    in units of its size and functions of the operating point that are orthonormal.
    """
    scaled = _Scaled.of(equations, functions)
    scale = float(np.linalg.norm(scaled.normalised.delta_stacked, 2)) or 1.0
    inequality = Inequality(*region.matrices, scaled.functions).scaled(scale)
    normalised = replace(scaled.normalised, delta=scaled.normalised.delta / scale)
    first = minimised_misfit(_weighted_by_x(normalised, inequality.with_margin(SLACK * margin / scale), misfit))
    factor = _root(first)
    inverse = np.asarray(solve_triangular(factor, np.eye(len(factor)), lower=True))
    second = minimised_misfit(_with_fixed_x(normalised, factor, inequality.with_margin(margin / scale), misfit))
    start = first.free if first.solved else normalised.dynamics() @ factor @ factor.T
    normal = second.free if second.solved else inverse @ start @ inverse.T
    certificate = float(np.linalg.eigvalsh(inequality.value(normal, np.eye(len(factor))))[:, -1].max())
    return ConstrainedDynamics(
        scaled.restored(scale * factor @ normal @ inverse),
        scale * certificate,
        first.iterations + second.iterations,
        first.solved or second.solved,
    )


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


def _root(solution: ConicSolution) -> FloatArray:
    """L of X = L Lᵀ, or I where the solver found no X."""
    size = len(solution.symmetric)
    return np.asarray(cholesky(solution.symmetric, lower=True)) if solution.solved else np.eye(size)


def _weighted_by_x(equations: ShiftEquations, inequality: Inequality, misfit: Misfit) -> Blocks:
    """The problem in Ã and X."""
    size = (equations.functions_a.shape[1], equations.order)
    return Blocks(size, misfit, lambda a, x: _residuals(equations, misfit, a, x), inequality.value, symmetric=True)


def _with_fixed_x(equations: ShiftEquations, factor: FloatArray, inequality: Inequality, misfit: Misfit) -> Blocks:
    """The problem in L⁻¹ A(p) L for X = L Lᵀ."""
    size = (equations.functions_a.shape[1], equations.order)
    turned = replace(equations, omega=equations.omega @ factor)
    inverse = np.asarray(solve_triangular(factor, np.eye(len(factor)), lower=True))

    def residuals(a: FloatArray, x: FloatArray) -> FloatArray:
        return _residuals(turned, misfit, a @ inverse, x)

    return Blocks(size, misfit, residuals, inequality.value, symmetric=False)


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
