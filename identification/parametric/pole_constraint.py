"""A(p) by least squares with all its poles in a region: a semidefinite programme [Kergus2019, Algorithm 2]."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from identification.arrays import FloatArray
from identification.parametric.conic_programme import Blocks, Misfit, minimised_misfit
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
    minimises ‖Ψ A_aug − Δ_aug‖ itself, without the weight X. Solved in a state basis in which Σ Ω_mᵀ Ω_m = I.
    """
    root = triangular_factor(equations.omega.reshape(-1, equations.order))
    basis = np.asarray(solve_triangular(root, np.eye(equations.order)))
    scaled = equations.in_basis(basis)
    first = minimised_misfit(_weighted_by_x(scaled, region, SLACK * margin, functions, misfit))
    factor = np.asarray(cholesky(first.symmetric, lower=True))
    inverse = np.asarray(solve_triangular(factor, np.eye(len(factor)), lower=True))
    second = minimised_misfit(_with_fixed_x(scaled, factor, region, margin, functions, misfit))
    normal = second.free if second.solved else inverse @ first.free @ inverse.T
    dynamics = basis @ factor @ normal @ inverse @ root
    certificate = float(
        np.linalg.eigvalsh(inequality(region, 0.0, normal, np.eye(len(factor)), functions))[:, -1].max()
    )
    return ConstrainedDynamics(
        dynamics, certificate, first.iterations + second.iterations, first.solved or second.solved
    )


def inequality(
    region: PoleRegion, margin: float, matrices: FloatArray, x: FloatArray, functions: FloatArray
) -> FloatArray:
    """(P + margin I) ⊗ X + Q ⊗ Ã(p) + Qᵀ ⊗ Ã(p)ᵀ, (V, …, rn, rn), of Ã (…, J, n, n) and X (…, n, n) at V points."""
    p, q = region.matrices
    shape = (len(functions), *matrices.shape[:-3], len(p) * x.shape[-1], len(p) * x.shape[-1])
    at_points = np.einsum("vj,...jab->v...ab", functions, matrices)
    from_a = np.einsum("rs,v...ab->v...rasb", q, at_points).reshape(shape)
    from_x = np.einsum("rs,...ab->...rasb", p + margin * np.eye(len(p)), x).reshape(shape[1:])
    return np.asarray(from_x + from_a + np.swapaxes(from_a, -1, -2))


def _weighted_by_x(
    equations: ShiftEquations, region: PoleRegion, margin: float, functions: FloatArray, misfit: Misfit
) -> Blocks:
    """The problem in Ã and X."""
    n, j = equations.order, equations.functions_a.shape[1]
    return Blocks(
        (j, n),
        misfit,
        residuals=lambda a, x: _residuals(equations, misfit, a, x),
        negative=lambda a, x: inequality(region, margin, a, x, functions),
        symmetric=True,
    )


def _with_fixed_x(
    equations: ShiftEquations,
    factor: FloatArray,
    region: PoleRegion,
    margin: float,
    functions: FloatArray,
    misfit: Misfit,
) -> Blocks:
    """The problem in L⁻¹ A(p) L for X = L Lᵀ."""
    n, j = equations.order, equations.functions_a.shape[1]
    turned = replace(equations, omega=equations.omega @ factor)
    inverse = np.asarray(solve_triangular(factor, np.eye(n), lower=True))
    return Blocks(
        (j, n),
        misfit,
        residuals=lambda a, x: _residuals(turned, misfit, a @ inverse, x),
        negative=lambda a, x: inequality(region, margin, a, x, functions),
        symmetric=False,
    )


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
