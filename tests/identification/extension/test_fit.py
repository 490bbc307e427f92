"""θ and effects together: exact without noise, and as accurate as the covariance says with it."""

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.inductance import Inductance
from identification.effects.rc_arc import RcArc
from identification.extension.fit import differences, fit
from identification.extension.model import ExtendedModel, placed
from identification.extension.rows import Rows
from identification.signals import FrequencyResponse
from tests.support.oscillators import MODEL, POINTS, THETA, batches, integrated, phasors, records

TRUE_DELAY = 0.03


def delayed(seed=0, sigma=1e-3):
    return batches(seed, sigma, extra=lambda w: np.exp(-1j * w * TRUE_DELAY))


def test_without_noise_the_truth_comes_back():
    found = fit(MODEL.plus(placed(Delay(), 0, 1)), Rows(delayed(sigma=1e-9)))
    assert found.outcome.ok
    assert found.model.parameters == pytest.approx([*THETA, TRUE_DELAY], rel=1e-5)


def test_errors_are_as_large_as_the_covariance_says():
    """4000 numbers of mean square one; a missing inflation or factor two would be seen."""
    z = []
    for seed in range(80):
        found = fit(MODEL.plus(placed(Delay(), 0, 1)), Rows(delayed(seed)))
        error = found.model.parameters - [*THETA, TRUE_DELAY]
        z.append(error @ np.linalg.solve(found.model.covariance, error))
    assert np.mean(z) == pytest.approx(5.0, rel=0.25)


def test_a_nonlinear_effect_is_fitted_with_its_own_sensitivity():
    g = np.random.default_rng(3)
    inputs = [phasors(g) for _ in POINTS[::2]]
    outputs = [(a, integrated(p, a, lambda x, v: 20.0 * x**3)) for p, a in zip(POINTS[::2], inputs, strict=True)]
    rows = Rows(gather(records(outputs, g, 1e-3, points=POINTS[::2])))
    found = fit(MODEL.plus(placed(CubicStiffness(), 0, 1)), rows, exact=True)
    sigma = np.sqrt(found.model.covariance[-1, -1])
    assert abs(found.model.parameters[-1] - 20.0) < 4 * sigma
    assert sigma < 0.3
    gradient = differences(found) @ found.residual
    assert np.linalg.norm(gradient / np.linalg.norm(found.tangents, axis=1)) < 0.2


def test_an_amplitude_may_depend_on_the_operating_point():
    omega = np.linspace(1, 9, 40)
    data = [
        FrequencyResponse(
            omega,
            MODEL.base.frequency_response([[p]], omega)[0] + 1j * omega * (2e-3 + 1e-3 * p),
            (p,),
            variance=np.full(40, 1e-12),
        )
        for p in POINTS
    ]
    found = fit(MODEL.plus(placed(Inductance(), 1, 1)), Rows(gather(data)))
    assert found.model.effects[0].coefficients == pytest.approx(np.array([[2e-3, 1e-3]]), rel=1e-4)


def test_an_amplitude_keeps_its_physical_sign():
    rows = Rows(batches(extra=lambda w: np.exp(1j * w * 0.01)))
    assert fit(MODEL.plus(placed(Delay(), 0, 1, 0.01)), rows).model.parameters[-1] >= 0


def test_without_a_known_noise_the_covariance_is_scaled_by_the_residual():
    g = np.random.default_rng(8)
    omega = np.geomspace(0.5, 20, 60)
    base = MODEL.base.frequency_response([[p] for p in POINTS], omega)
    noise = 1 + 0.05 * (g.standard_normal(base.shape) + 1j * g.standard_normal(base.shape)) / np.sqrt(2)
    data = [FrequencyResponse(omega, row, (p,)) for p, row in zip(POINTS, base * noise, strict=True)]
    found = fit(MODEL, Rows(gather(data)))
    error = found.model.parameters - THETA
    assert 0.3 < error @ np.linalg.solve(found.model.covariance, error) / 4 < 3.5


def test_parameters_go_round():
    model = MODEL.plus(placed(RcArc(time=0.3), 1, 1, 0.2)).plus(placed(Delay(), 0, 1, 0.1))
    moved = model.with_parameters(model.parameters * 2)
    assert np.array_equal(moved.parameters, 2 * model.parameters)
    assert moved.effects[0].effect == RcArc(time=0.6)
    assert isinstance(moved, ExtendedModel)
