"""More first models for a likelihood search that ended in the wrong valley."""

import numpy as np

from identification.arrays import FloatArray
from identification.varying.harmonic_blocks import HarmonicBlocks
from identification.varying.periodic_residuals import PeriodicResiduals
from identification.varying.stacks import StackSizes

SHRINK = 0.8
FOLLOWED = 6


def perturbed_starts(
    residuals: PeriodicResiduals, theta: FloatArray, count: int, generator: np.random.Generator
) -> list[FloatArray]:
    """The best six of `count` models whose A_i, C_i are drawn around those of θ, B_i and D_i by linear least squares.

    A_i (i > 0) are drawn as large as A_0 at most, C_i as large as C_0; A_0 and C_0 are disturbed as much in every
    second model. All A_i are shrunk until the model is stable over a scheduling period.
    """
    sizes = residuals.blocks.sizes
    found = []
    for k in range(count):
        a, b, c, d = (part.copy() for part in sizes.split(theta))
        for stack in (a, c):
            scale = np.linalg.norm(stack[0]) / np.sqrt(stack[0].size) * generator.uniform(0.2, 1.0)
            stack[k % 2 :] += scale * generator.standard_normal(stack[k % 2 :].shape)
        candidate = stabilised(residuals.blocks, sizes.join((a, b, c, d)))
        candidate = with_fitted_inputs(residuals, candidate)
        residual = residuals.residual(candidate)
        found.append((float(residual @ residual), k, candidate))
    return [candidate for _, _, candidate in sorted(found)[:FOLLOWED]]


def stabilised(blocks: HarmonicBlocks, theta: FloatArray) -> FloatArray:
    """θ with all A_i multiplied by powers of 0.8 until the model is stable over a scheduling period."""
    sizes: StackSizes = blocks.sizes
    end = sizes.shapes[0][0] * sizes.order**2
    while not blocks.stable(theta):
        theta = np.concatenate([SHRINK * theta[:end], theta[end:]])
    return theta


def with_fitted_inputs(residuals: PeriodicResiduals, theta: FloatArray) -> FloatArray:
    """θ with those B_i, D_i that fit best given A_i, C_i: the response is linear in them."""
    sizes = residuals.blocks.sizes
    _, b, _, d = sizes.split(np.arange(sizes.size, dtype=np.float64))
    linear = np.concatenate([b.ravel(), d.ravel()]).astype(np.int64)
    residual, jacobian = residuals(theta)
    step = np.linalg.lstsq(jacobian[:, linear], -residual, rcond=1e-10)[0]
    changed = theta.copy()
    changed[linear] += step
    return changed
