"""What the comparison with PySINDy rests on, without PySINDy: its simulation and the measure of the error."""

import numpy as np
import pytest

from benchmarks.peer_sindy import HIDDEN, TERMS, derived, errors, part
from benchmarks.virtual_bench.bench import Bench, experiments, noisy

TRUE = {"u": 1.0, "x": -64.0, "p x": -28.0, "v": -1.8}
ALL = experiments(np.random.default_rng(5), points=3, levels=(15.0,))
DONE = part(ALL, slice(0, 2))


def coefficients(**more):
    terms = {**TRUE, **more}
    return np.array([[terms.get(name, 0.0) for name in TERMS]])


@pytest.mark.parametrize(("kind", "strength"), [("cubic_stiffness", 5.0), ("quadratic_damping", 0.2)])
def test_the_true_equation_has_no_error_and_the_linear_one_has(kind, strength):
    truth = Bench(((kind, strength),)).steady(DONE)
    both = np.concatenate([coefficients(**{HIDDEN[kind]: -strength}), coefficients()])
    right, linear = errors(both, DONE, truth)
    assert right < 1e-6
    assert linear > 0.02


def test_an_equation_that_diverges_has_an_infinite_error():
    assert errors(coefficients(v=50.0), DONE, Bench().steady(DONE))[0] == np.inf


def test_derivatives_fulfil_the_equation_of_motion():
    records = noisy(Bench().steady(DONE), DONE, 1e-6, np.random.default_rng(0))
    for data in derived(records):
        found = sum(c * TERMS[name](data.x, data.v, data.u, DONE.points[:, None]) for name, c in TRUE.items())
        assert np.linalg.norm(found - data.a) < 2e-3 * np.linalg.norm(data.a)
