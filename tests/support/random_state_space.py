"""Random affine state-space models that are stable for any scheduling in [−1, 1]^n, and the signals of a study."""

from itertools import product

import numpy as np

from benchmarks.affine_plant import AffinePlant
from identification.arrays import FloatArray
from identification.varying.records import VaryingRecord


def random_affine(
    rng: np.random.Generator,
    order: int = 4,
    n_scheduling: int = 5,
    n_inputs: int = 2,
    n_outputs: int = 2,
    contraction: float = 0.9,
) -> tuple[AffinePlant, FloatArray]:
    """A model and P with A(p)ᵀ P A(p) ⪯ contraction² P on [−1, 1]^n_p, normal entries otherwise.

    The largest norm of A(p) is at a vertex; scaled to `contraction`, then the state coordinates are changed.
    """
    k = n_scheduling + 1
    a, b = rng.standard_normal((k, order, order)), rng.standard_normal((k, order, n_inputs))
    c, d = rng.standard_normal((k, n_outputs, order)), rng.standard_normal((k, n_outputs, n_inputs))
    vertices = np.array(list(product([-1.0, 1.0], repeat=n_scheduling)))
    at_vertices = a[0] + np.einsum("vk,kij->vij", vertices, a[1:])
    a *= contraction / np.linalg.norm(at_vertices, 2, axis=(1, 2)).max()
    basis = np.linalg.qr(rng.standard_normal((order, order)))[0] * rng.uniform(0.5, 2.0, order)
    return AffinePlant(a, b, c, d, 1.0).transformed(basis), basis.T @ basis


def white_record(model: AffinePlant, rng: np.random.Generator, samples: int, level: float) -> VaryingRecord:
    """Uniform white input, binary white scheduling ±0.9, white noise at `level` dB below the output [Cox2018, 5.1]."""
    u = rng.uniform(-1.0, 1.0, (samples, model.n_inputs))
    p = rng.choice([-0.9, 0.9], (samples, model.n_scheduling))
    return noisy_record(model, u, p, rng, level)


def noisy_record(
    model: AffinePlant, u: FloatArray, p: FloatArray, rng: np.random.Generator, level: float
) -> VaryingRecord:
    """The response to u (N, n_u) along p (N, n_p) with white noise `level` dB below each output; none at infinity."""
    y = model.simulate(u, p)
    deviation = np.sqrt(np.mean(y**2, axis=0)) * 10 ** (-level / 20)
    return VaryingRecord(u, y + deviation * rng.standard_normal(y.shape), p, model.sample_time)


def slow_record(model: AffinePlant, rng: np.random.Generator, samples: int = 200) -> VaryingRecord:
    """The noise-free validation record of [Cox2018, 5.1], for two inputs."""
    t = np.arange(1, samples + 1)
    i = np.arange(1, model.n_scheduling + 1)
    u = 0.5 * np.column_stack([np.cos(0.035 * t), np.sin(0.035 * t)]) + rng.uniform(-0.15, 0.15, (samples, 2))
    p = 0.25 - 0.05 * i + 0.4 * np.sin(0.035 * t[:, None] + 2 * i * np.pi / 5)
    p += rng.uniform(-0.15, 0.15, p.shape)
    return VaryingRecord(u, model.simulate(u, p), p, model.sample_time)
