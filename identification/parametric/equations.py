"""The linear equations of all operating points together: A and C from the subspaces, B and D from the responses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError
from identification.models.resolvent import resolvent
from identification.parametric.shift_basis import ShiftBasis
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse


@dataclass(frozen=True, eq=False)
class ShiftEquations:
    """Ω_m A(p_m) = Δ_m and C(p_m) = Λ_m at every operating point [Kergus2019, (14)].

    `omega`, `delta`: (M, (q − 1) n_y, n); `output`: (M, n_y, n); `functions_a` (M, J_A), `functions_c` (M, J_C): the
    basis functions of A and C at the operating points.
    """

    omega: FloatArray
    delta: FloatArray
    output: FloatArray
    functions_a: FloatArray
    functions_c: FloatArray

    @property
    def order(self) -> int:
        """n."""
        return int(self.omega.shape[2])

    @property
    def psi(self) -> FloatArray:
        """Ψ (M (q − 1) n_y, J_A n), block row m is [f_1(p_m) Ω_m, f_2(p_m) Ω_m, …] [Kergus2019, (15)]."""
        product = self.functions_a[:, None, :, None] * self.omega[:, :, None, :]
        return np.asarray(product.reshape(-1, self.functions_a.shape[1] * self.order))

    @property
    def delta_stacked(self) -> FloatArray:
        """Δ_aug (M (q − 1) n_y, n)."""
        return self.delta.reshape(-1, self.order)

    def dynamics(self) -> FloatArray:
        """A_1 … A_J by least squares, Ψ A_aug = Δ_aug, as (J_A, n, n)."""
        solution = _least_squares(self.psi, self.delta_stacked, "order")
        return np.asarray(solution.reshape(-1, self.order, self.order))

    def outputs(self) -> FloatArray:
        """C_1 … C_J by least squares, Γ C_aug = Λ_aug, as (J_C, n_y, n)."""
        solution = _least_squares(self.functions_c, self.output.reshape(len(self.output), -1), "operating_points")
        return np.asarray(solution.reshape(-1, *self.output.shape[1:]))

    def in_basis(self, basis: FloatArray) -> "ShiftEquations":
        """The same equations for the state T⁻¹ x, T (n, n)."""
        return ShiftEquations(
            self.omega @ basis, self.delta @ basis, self.output @ basis, self.functions_a, self.functions_c
        )


def shift_equations(
    observabilities: Sequence[FloatArray], basis: ShiftBasis, dependence: ParameterDependence, points: FloatArray
) -> ShiftEquations:
    """The equations of observability matrices O_m (q n_y, n) that share one state basis."""
    stacked = np.stack(observabilities)
    blocks = stacked.reshape(len(stacked), basis.size, -1, stacked.shape[2])
    shifted = np.einsum("ik,miyn->mkyn", basis.shift, blocks)
    flat = (len(stacked), -1, stacked.shape[2])
    functions = [b.evaluate(points, dependence.variables) for b in (dependence.bases[0], dependence.bases[2])]
    return ShiftEquations(blocks[:, :-1].reshape(flat), shifted.reshape(flat), blocks[:, 0], functions[0], functions[1])


def input_matrices(
    dynamics: FloatArray,
    outputs: FloatArray,
    experiments: Sequence[FrequencyResponse],
    lines: Sequence[ComplexArray],
    dependence: ParameterDependence,
    points: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """B (J_B, n, n_u) and D (J_D, n_y, n_u) of given A (J_A, n, n) and C (J_C, n_y, n) by weighted least squares.

        min Σ_m Σ_i ‖(Ĝ_i − D(p_m) − C(p_m) (z_i I − A(p_m))⁻¹ B(p_m)) / σ_i‖²                  [Kergus2019, (16)]

    σ_i² are the variances of the data, all equal when they state none.
    """
    f_a, f_b, f_c, f_d = (basis.evaluate(points, dependence.variables) for basis in dependence.bases)
    n, n_y, n_u = dynamics.shape[1], outputs.shape[1], experiments[0].input_count
    rows, values, weights = [], [], []
    for m, (data, z) in enumerate(zip(experiments, lines, strict=True)):
        a, c = np.tensordot(f_a[m], dynamics, axes=1), np.tensordot(f_c[m], outputs, axes=1)
        states = resolvent(a, np.eye(n), c, z)
        direct = np.broadcast_to(np.eye(n_y), (len(z), n_y, n_y))
        rows.append(
            np.concatenate([np.kron(f_b[m], states), np.kron(f_d[m], direct)], axis=-1).reshape(len(z) * n_y, -1)
        )
        values.append(data.matrices.reshape(-1, n_u))
        weights.append(np.ones(values[-1].shape) if data.variance is None else data.variance.reshape(-1, n_u) ** -0.5)
    solution = _by_input(np.concatenate(rows), np.concatenate(values), np.concatenate(weights))
    split = f_b.shape[1] * n
    return solution[:split].reshape(-1, n, n_u), solution[split:].reshape(-1, n_y, n_u)


def _by_input(rows: ComplexArray, values: ComplexArray, weights: FloatArray) -> FloatArray:
    """One weighted least-squares problem per input, its matrix shared while the weights are."""
    if np.all(weights == weights[:, :1]):
        return _weighted(rows, values, weights[:, 0])
    columns = [_weighted(rows, values[:, u : u + 1], weights[:, u]) for u in range(values.shape[1])]
    return np.hstack(columns)


def _weighted(rows: ComplexArray, values: ComplexArray, weights: FloatArray) -> FloatArray:
    scaled, target = weights[:, None] * rows, weights[:, None] * values
    real = np.concatenate([scaled.real, scaled.imag])
    return _least_squares(real, np.concatenate([target.real, target.imag]), "frequencies")


def _least_squares(matrix: FloatArray, target: FloatArray, field: str) -> FloatArray:
    scale = np.linalg.norm(matrix, axis=0)
    if not np.all(scale > 0) or len(matrix) < matrix.shape[1]:
        raise NotIdentifiableError(
            "the data do not determine all coefficients; measure more lines or operating points, or lower the order",
            field,
        )
    solution = np.linalg.lstsq(matrix / scale, target, rcond=1e-14)[0]
    return np.asarray(solution / scale[:, None])
