"""Parametric plants in observability canonical form, and the example of the parametric subspace paper."""

import numpy as np

from identification.bases.polynomial import Polynomial
from identification.models.state_space_model import state_space_model
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse

SAMPLE_TIME = 1e-3
LINES = np.logspace(-1, np.log10(np.pi / SAMPLE_TIME), 400)
P = SchedulingVariable("p", "", 0.0, 1.0)


def dependence(*degrees, variables=(P,)):
    """Polynomials of these degrees for A, B, C and D."""
    bases = tuple(ProductBasis((Polynomial(k),) * len(variables), k) for k in degrees)
    return ParameterDependence(variables, bases)


AFFINE = dependence(1, 1, 1, 1)


def example_response(p, omega=LINES):
    """(1 + p)/(z² + 0.01 p z + 0.99), z = e^{jωT}, (F,)."""
    z = np.exp(1j * omega * SAMPLE_TIME)
    return (1 + p) / (z**2 + 0.01 * p * z + 0.99)


def example_data(generator=None, points=(0.2, 0.8), snr=5.0):
    """The example's data: noise-free, or with the multiplicative noise 10^(−SNR/10) (N + jN)."""
    result = []
    for p in points:
        response = example_response(p)
        if generator is not None:
            noise = generator.standard_normal((len(LINES), 2)) @ [1, 1j]
            response = response * (1 + 10 ** (-snr / 10) * noise)
        result.append(FrequencyResponse(LINES, response, (p,), SAMPLE_TIME))
    return result


def canonical_plant(generator, counts, inputs, depends, sample_time):
    """A random plant whose state are the first `counts` rows of each output, with matrices that vary gently with p."""
    g, order, outputs = generator, sum(counts), len(counts)
    sizes = [basis.size for basis in depends.bases]
    a, starts = np.zeros((sizes[0], order, order)), np.cumsum([0, *counts[:-1]])
    c = np.zeros((sizes[2], outputs, order))
    for y, (start, count) in enumerate(zip(starts, counts, strict=True)):
        for k in range(count - 1):
            a[0, start + k, start + k + 1] = 1.0
        pairs = 0.8 * np.exp(1j * g.uniform(0.4, 2.6, count // 2))
        poles = [*pairs, *pairs.conj(), *([g.uniform(-0.7, 0.7)] if count % 2 else [])]
        if sample_time is None:
            poles = [complex(-0.3, 1.0 + abs(np.angle(z))) if z.imag > 0 else z for z in poles]
            poles = [complex(-0.3, -1.0 - abs(np.angle(z))) if np.imag(z) < 0 else z for z in poles]
            poles = [z - 1.5 if np.imag(z) == 0 else z for z in poles]
        a[0, start + count - 1, start : start + count] = -np.poly(poles)[:0:-1].real
        c[0, y, start] = 1.0
    for y, start in enumerate(starts):
        a[1:, start + counts[y] - 1] = 0.04 * g.standard_normal((sizes[0] - 1, order))
    b = g.standard_normal((sizes[1], order, inputs))
    d = g.standard_normal((sizes[3], outputs, inputs))
    return state_space_model(depends.variables, depends.bases, (a, b, c, d), sample_time)


def dense_plant(generator, depends, sample_time):
    """A plant of order three, two inputs and outputs, with no zeros in its matrices, stable for degree one."""
    g, sizes = generator, [basis.size for basis in depends.bases]
    a = np.concatenate(
        [[[[0.5, 0.6, 0], [-0.6, 0.5, 0.1], [0.2, 0, -0.5]]], 0.15 * g.standard_normal((sizes[0] - 1, 3, 3))]
    )
    b, c, d = (g.standard_normal((j, *s)) for j, s in zip(sizes[1:], [(3, 2), (2, 3), (2, 2)], strict=True))
    return state_space_model(depends.variables, depends.bases, (a, b, c, d), sample_time)


def responses(plant, points, omega, generator=None, level=0.0, variances=False):
    """Its frequency responses at some operating points, with noise of `level` times the root mean square response."""
    result = []
    for point in points:
        clean = plant.frequency_response([point], omega)[0]
        size = level * np.sqrt(np.mean(abs(clean) ** 2))
        noise = 0.0 if generator is None else generator.standard_normal((*clean.shape, 2)) @ [1, 1j] * size / np.sqrt(2)
        variance = np.full(clean.shape, size**2) if variances else None
        result.append(FrequencyResponse(omega, clean + noise, tuple(point), plant.structure.sample_time, variance))
    return result


def worst_relative_error(model, plant, points, omega):
    """The largest error of the response over points and lines, relative to the largest response at the point."""
    truth, found = plant.frequency_response(points, omega), model.frequency_response(points, omega)
    size = np.linalg.norm(truth, axis=(2, 3)).max(axis=1)
    return float((np.linalg.norm(found - truth, axis=(2, 3)).max(axis=1) / size).max())
