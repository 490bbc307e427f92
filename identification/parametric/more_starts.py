"""More models to begin with where a likelihood search over frequency responses ended in the wrong valley."""

from collections.abc import Sequence

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError, RangeError
from identification.models.model import Model
from identification.models.state_space_model import stacks, state_space_model
from identification.parametric.equations import input_matrices
from identification.parametric.state_space_residuals import whitened_error, whitener
from identification.signals import FrequencyResponse

FOLLOWED = 6


def drawn_starts(
    model: Model,
    experiments: Sequence[FrequencyResponse],
    count: int,
    generator: np.random.Generator,
) -> list[Model]:
    """The best six of `count` models whose A(p), C(p) are drawn around those of a model in the middle of its data.

    Each A_j, C_j is drawn as large as A, C at most, over the mean size of its function; in every second model the
    constant parts stay what they are. B and D follow by linear least squares [Kergus2019, (16)].
    """
    points = np.array([data.operating_point for data in experiments], dtype=np.float64)
    lines = [_variable(data) for data in experiments]
    whiteners = [whitener(data) for data in experiments]
    middle = _middle(model, points)
    found: list[tuple[float, int, Model]] = []
    for k in range(count):
        try:
            candidate = _drawn(model, middle, points, experiments, lines, k % 2 == 0, generator)
            error = whitened_error(candidate, experiments, whiteners)
        except (NotIdentifiableError, RangeError, np.linalg.LinAlgError):
            continue
        found.append((float(error @ error), k, candidate))
    return [candidate for cost, _, candidate in sorted(found, key=lambda one: one[:2])[:FOLLOWED] if np.isfinite(cost)]


def _middle(model: Model, points: FloatArray) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """Of A and C: the mean over the points, how functions give a constant (J,), and their mean sizes (J,)."""
    bases, matrices = model.dependence.bases, stacks(model)
    found = []
    for basis, stack in ((bases[0], matrices[0]), (bases[2], matrices[2])):
        psi = basis.evaluate(points, model.variables)
        constant = np.linalg.lstsq(psi, np.ones(len(psi)), rcond=None)[0]
        sizes = np.sqrt(np.mean(psi**2, axis=0))
        sizes = np.where(sizes > 0, sizes, 1.0).astype(np.float64)
        found.append((np.asarray(np.tensordot(psi.mean(axis=0), stack, 1)), np.asarray(constant), sizes))
    return found


def _variable(data: FrequencyResponse) -> ComplexArray:
    s = 1j * data.frequencies
    return np.asarray(s if data.sample_time is None else np.exp(s * data.sample_time))


def _drawn(
    model: Model,
    middle: list[tuple[FloatArray, FloatArray, FloatArray]],
    points: FloatArray,
    experiments: Sequence[FrequencyResponse],
    lines: Sequence[ComplexArray],
    kept: bool,
    generator: np.random.Generator,
) -> Model:
    parts = []
    for mean, constant, sizes in middle:
        scale = np.linalg.norm(mean) / np.sqrt(mean.size) * generator.uniform(0.2, 1.0)
        noise = scale * generator.standard_normal((len(constant), *mean.shape)) / sizes[:, None, None]
        if kept:
            noise[constant != 0] *= abs(constant[constant != 0][:, None, None]) < 1e-9
        parts.append(constant[:, None, None] * mean + noise)
    a, c = parts
    b, d = input_matrices(a, c, experiments, lines, model.dependence, points)
    bases, step = model.dependence.bases, model.structure.sample_time
    return state_space_model(model.variables, bases, (a, b, c, d), step)
