"""A first model from spectra: the best linear time-invariant approximation with the extended input."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError
from identification.models.state_space import Matrices
from identification.varying.harmonic_blocks import HarmonicBlocks
from identification.varying.stacks import StackSizes

STABLE_RADIUS = 0.95


def input_affine_start(
    blocks: HarmonicBlocks, spectrum: ComplexArray, deviation: FloatArray, block_rows: int
) -> Matrices:
    """Stacks with A_i = 0, C_i = 0 for i > 0, and any B_i, D_i [Goos2014, (28), (29)].

        z_k X_k = A_0 X_k + Σ_i B_i (φ_i u)_k,   Y_k = C_0 X_k + Σ_i D_i (φ_i u)_k

    A_0 and C_0 come from the column space of the stacked z^j Y_k, j < `block_rows`, from which the stacked extended
    inputs are projected out [McKelvey1996, Algorithm 2]; B_i and D_i by linear least squares. Y (F, n_y) = `spectrum`
    at `blocks.lines`, weighted by 1/`deviation` (F,). An unstable A_0 is shrunk. Raises NotIdentifiableError when the
    lines are too few or do not excite the extended input.
    """
    sizes = blocks.sizes
    lines = np.asarray(2 * np.pi * blocks.lines / blocks.period)
    z = np.exp(1j * lines)
    inputs = blocks.extended_input[blocks.lines].reshape(len(lines), -1)
    weight = (np.median(deviation) / deviation)[:, None]
    a, c = _dynamics(z, inputs * weight, spectrum * weight, sizes, block_rows)
    radius = float(abs(np.linalg.eigvals(a)).max())
    a = a * min(1.0, STABLE_RADIUS / max(radius, 1e-12))
    b, d = _inputs(z, inputs, spectrum, weight, a, c)
    m, n, n_u, n_y = sizes.functions, sizes.order, sizes.n_inputs, sizes.n_outputs
    stack_a, stack_c = np.zeros((m, n, n)), np.zeros((m, n_y, n))
    stack_a[0], stack_c[0] = a, c
    return stack_a, b.reshape(n, m, n_u).transpose(1, 0, 2), stack_c, d.reshape(n_y, m, n_u).transpose(1, 0, 2)


def _dynamics(
    z: ComplexArray, inputs: ComplexArray, spectrum: ComplexArray, sizes: StackSizes, block_rows: int
) -> tuple[FloatArray, FloatArray]:
    powers = z[:, None] ** np.arange(block_rows)
    u, y = (_real_rows(powers[:, :, None] * part[:, None, :]) for part in (inputs, spectrum))
    if u.shape[1] < len(u) + sizes.order:
        raise NotIdentifiableError(
            f"{len(z)} lines are too few for {block_rows} block rows of the extended input; choose a longer period",
            "period",
        )
    basis, triangle = np.linalg.qr(u.T)
    diagonal = abs(np.diag(triangle))
    if diagonal.min() <= 1e-10 * diagonal.max():
        raise NotIdentifiableError(
            "the input and its products with the scheduling are linearly dependent: the excitation has too low a rank;"
            " excite more lines",
            "input",
        )
    left = y - (y @ basis) @ basis.T
    column_space, _, _ = np.linalg.svd(left, full_matrices=False)
    observability = column_space[:, : sizes.order]
    n_y = sizes.n_outputs
    a = np.linalg.lstsq(observability[:-n_y], observability[n_y:], rcond=None)[0]
    return np.asarray(a, dtype=np.float64), np.asarray(observability[:n_y])


def _real_rows(columns: ComplexArray) -> FloatArray:
    flat = columns.reshape(len(columns), -1).T
    return np.concatenate([flat.real, flat.imag], axis=1)


def _inputs(
    z: ComplexArray, inputs: ComplexArray, spectrum: ComplexArray, weight: FloatArray, a: FloatArray, c: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """B (n_x, inputs) and D (n_y, inputs) by least squares."""
    n, (n_y, n_in) = len(a), (len(c), inputs.shape[1])
    response = c @ np.linalg.inv(z[:, None, None] * np.eye(n) - a)
    of_b = response[:, :, :, None] * inputs[:, None, None, :]
    of_d = np.eye(n_y)[None, :, :, None] * inputs[:, None, None, :]
    columns = np.concatenate([part.reshape(len(z), n_y, -1) for part in (of_b, of_d)], axis=2) * weight[:, :, None]
    target = (spectrum * weight).reshape(-1)
    flat = columns.reshape(len(target), -1)
    solved = np.linalg.lstsq(
        np.concatenate([flat.real, flat.imag]), np.concatenate([target.real, target.imag]), rcond=1e-12
    )[0]
    return solved[: n * n_in].reshape(n, n_in), solved[n * n_in :].reshape(n_y, n_in)
