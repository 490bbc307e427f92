"""Random affine models and records for the tests of this folder."""

import numpy as np

from benchmarks.affine_plant import AffinePlant
from identification.along import simulate_along
from identification.arrays import FloatArray
from identification.models.model import Model
from identification.varying.records import VaryingRecord


def random_model(
    generator: np.random.Generator, order: int = 2, n_p: int = 1, n_u: int = 1, n_y: int = 1
) -> AffinePlant:
    """Stable for |p_i| ≤ 1: the spectral norms of the A_i add up to less than one."""
    a = generator.standard_normal((n_p + 1, order, order))
    norms = np.linalg.norm(a, 2, axis=(1, 2))
    a = a / norms[:, None, None] * np.concatenate([[0.6], np.full(n_p, 0.3 / n_p)])[:, None, None]
    shapes = ((n_p + 1, order, n_u), (n_p + 1, n_y, order), (n_p + 1, n_y, n_u))
    return AffinePlant(a, *(generator.standard_normal(shape) for shape in shapes))


def step_by_step(model: AffinePlant, u: FloatArray, p: FloatArray, x: FloatArray) -> FloatArray:
    """The output by the equations, one sample after the other."""
    rows = []
    for t in range(len(u)):
        weights = np.concatenate([[1.0], p[t]])
        a, b, c, d = (np.tensordot(weights, part, 1) for part in (model.a, model.b, model.c, model.d))
        rows.append(c @ x + d @ u[t])
        x = a @ x + b @ u[t]
    return np.array(rows)


def periodic_record(
    model: AffinePlant,
    generator: np.random.Generator,
    period: int,
    scheduling_period: int,
    periods: int,
    noise: float = 0.0,
) -> VaryingRecord:
    """From rest; `noise` relative to the deviation of each output."""
    u = np.tile(generator.standard_normal((period, model.n_inputs)), (periods, 1))
    p = generator.uniform(-1, 1, (scheduling_period, model.n_scheduling))
    p = np.tile(p, (periods * period // scheduling_period, 1))
    y = model.simulate(u, p)
    return VaryingRecord(u, y + noise * y.std(axis=0) * generator.standard_normal(y.shape), p, 1.0, period)


def output_along(model: Model, u: FloatArray, p: FloatArray) -> FloatArray:
    """The output of a model from rest."""
    return simulate_along(model, u, p, covariance_known=False).output
