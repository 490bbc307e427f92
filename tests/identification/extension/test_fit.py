"""θ and effects together: exact without noise, and as accurate as the covariance says with it."""

from dataclasses import dataclass

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.inductance import Inductance
from identification.effects.rc_arc import RcArc
from identification.extension.fit import differences, fit
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.places.placed import placed
from identification.places.steady import NoSteadyStateError
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
        z.append(error @ np.linalg.solve(found.model.joint_covariance, error))
    assert np.mean(z) == pytest.approx(5.0, rel=0.25)


def test_a_nonlinear_effect_is_fitted_with_its_own_sensitivity():
    g = np.random.default_rng(3)
    inputs = [phasors(g) for _ in POINTS[::2]]
    outputs = [(a, integrated(p, a, lambda x, v: 20.0 * x**3)) for p, a in zip(POINTS[::2], inputs, strict=True)]
    rows = Rows(gather(records(outputs, g, 1e-3, points=POINTS[::2])))
    found = fit(MODEL.plus(placed(CubicStiffness(), 0, 1)), rows, exact=True)
    sigma = np.sqrt(found.model.joint_covariance[-1, -1])
    assert abs(found.model.parameters[-1] - 20.0) < 4 * sigma
    assert sigma < 0.3
    gradient = differences(found) @ found.residual
    assert np.linalg.norm(gradient / np.linalg.norm(found.tangents, axis=1)) < 0.2


def test_an_amplitude_may_depend_on_the_operating_point():
    omega = np.linspace(1, 9, 40)
    data = [
        FrequencyResponse(
            omega,
            MODEL.frequency_response([[p]], omega)[0, :, 0, 0] + 1j * omega * (2e-3 + 1e-3 * p),
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
    base = MODEL.frequency_response([[p] for p in POINTS], omega)[..., 0, 0]
    noise = 1 + 0.05 * (g.standard_normal(base.shape) + 1j * g.standard_normal(base.shape)) / np.sqrt(2)
    data = [FrequencyResponse(omega, row, (p,)) for p, row in zip(POINTS, base * noise, strict=True)]
    found = fit(MODEL, Rows(gather(data)))
    error = found.model.parameters - THETA
    assert 0.3 < error @ np.linalg.solve(found.model.joint_covariance, error) / 4 < 3.5


def test_parameters_go_round():
    model = MODEL.plus(placed(RcArc(time=0.3), 1, 1, 0.2)).plus(placed(Delay(), 0, 1, 0.1))
    moved = model.with_parameters(model.parameters * 2)
    assert np.array_equal(moved.parameters, 2 * model.parameters)
    assert moved.effects[0].effect == RcArc(time=0.6)
    assert isinstance(moved, Model)


@dataclass(frozen=True)
class Brittle(CubicStiffness):
    """Nothing up to the limit of the position; beyond it a force that no steady state can bear."""

    limit: float = 0.0

    def force(self, x, velocity):
        return np.where(abs(x).max(axis=1, keepdims=True) > self.limit, 1e9 * x, 0.0 * x)


def test_derivatives_at_the_edge_of_what_has_a_steady_state_are_taken_to_the_other_side():
    """Not read off the tangent, which leaves the loop around the stiffness out."""
    rows = Rows(batches(4, 0.3))
    hardening = MODEL.plus(placed(CubicStiffness(), 0, 1, 15.0))
    steady = hardening.respond(rows.batches[0])
    brittle = Brittle(limit=1.0001 * abs(steady.motion(0, False, 2)[0]).max())
    at_the_edge = fit(hardening.plus(placed(brittle, 0, 1, 1.0)), rows, iterations=0, start=[steady])
    gain = len(THETA) - 1
    step = 0.1 / np.linalg.norm(at_the_edge.tangents[gain])
    values = at_the_edge.model.parameters
    more, less = (values + sign * step * np.eye(len(values))[gain] for sign in (1, -1))
    (flow,) = at_the_edge.flows
    with pytest.raises(NoSteadyStateError):
        at_the_edge.model.with_parameters(more).respond(flow.batch, flow)
    change = at_the_edge.model.with_parameters(less).respond(flow.batch, flow).output - flow.output
    assert differences(at_the_edge)[gain] == pytest.approx(rows.whiten([change]) / -step)
