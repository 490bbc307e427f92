"""McKelvey 2 on noisy data: the subspace of the algorithm as written, consistency, stability, order, misuse."""

import numpy as np
import pytest
from scipy.linalg import subspace_angles

from benchmarks.subspace_consistency import run
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.models.system import StateSpace
from identification.signals import FrequencyResponse
from identification.subspace.frequency_subspace import FrequencySubspace
from identification.subspace.input_matrices import input_matrices
from identification.subspace.noise import Noise
from identification.subspace.observability import observability_range
from tests.support.literal_subspace import literal_observability, literal_subspace
from tests.support.state_space import exact, noisy, random_system, relative_error

BETWEEN = np.linspace(0.001, 3.14, 300)


def measured(order=4, inputs=2, outputs=3, count=200, deviation=0.05, seed=1):
    g = np.random.default_rng(seed)
    system = random_system(g, order, inputs, outputs, 1.0)
    omega = np.sort(g.uniform(0.05, 3.1, count))
    return system, noisy(system, omega, np.broadcast_to(deviation, count), g)


@pytest.mark.parametrize("weighted", [True, False])
def test_the_subspace_is_that_of_the_algorithm_as_written(weighted):
    _, data = measured(deviation=0.3 * np.exp(np.linspace(0, 3, 200)))
    q, z = 8, np.exp(1j * data.frequencies)
    written, sizes = literal_observability(
        data.frequencies, data.response, 1.0, q, data.variance[:, 0, 0] if weighted else None
    )
    noise = Noise.of(data, "variance" if weighted else "none")
    found = observability_range(z, data.response, noise, q, 4, unweighted=not weighted)
    powers = np.zeros((q, q))
    powers[0, 0] = 1.0
    for i in range(1, q):
        powers[i] = found.shift @ powers[i - 1]
    ours = np.einsum("ij,pjn->ipn", powers, found.columns).reshape(q * 3, 4)
    assert subspace_angles(ours, written[:, :4]).max() < 1e-9
    ratio = found.singular_values / sizes
    assert np.allclose(ratio, ratio[0], rtol=1e-8)


def test_the_model_is_near_that_of_the_algorithm_as_written():
    system, data = measured(deviation=0.02)
    written = literal_subspace(data.frequencies, data.response, 1.0, 4, 8, data.variance[:, 0, 0])
    ours = FrequencySubspace(order=4, block_rows=8).estimate(data).model
    error = relative_error(written, system, BETWEEN)
    assert relative_error(ours, system, BETWEEN) < 1.2 * error
    assert relative_error(ours, written, BETWEEN) < error


def test_consistency_with_the_variances_and_bias_without():
    result = run([100, 1000, 10000], runs=6)
    weighted, unweighted, equidistant = (row["errors"] for row in result["methods"])
    assert result["methods"][0]["slope"] == pytest.approx(-0.5, abs=0.1)
    assert equidistant[-1] < 0.2 * equidistant[0]
    assert unweighted[-1] > 0.5 * unweighted[0]
    assert unweighted[-1] > 20 * weighted[-1]


def test_correlated_noise_is_weighted_with():
    """Noise along one direction of the outputs is seen through where its covariance is stated."""
    g = np.random.default_rng(3)
    system = random_system(g, 2, 1, 2, 1.0)
    omega = np.linspace(0.05, 3.1, 300)
    truth = system.frequency_response(omega)
    direction = np.array([1.0, 1.0])[:, None]
    wave = 0.5 * (g.standard_normal(300) + 1j * g.standard_normal(300))[:, None, None]
    small = 1e-3 * (g.standard_normal(truth.shape) + 1j * g.standard_normal(truth.shape))
    covariance = np.tile(0.5 * direction @ direction.T + 2e-6 * np.eye(2), (300, 1, 1))
    response = truth + wave * direction + small
    method = FrequencySubspace(order=2, block_rows=6)
    stated = method.estimate(FrequencyResponse(omega, response, (0.0,), 1.0, covariance=covariance))
    diagonal = np.full(truth.shape, 0.5)
    ignored = method.estimate(FrequencyResponse(omega, response, (0.0,), 1.0, diagonal))
    difference = np.array([[1.0, -1.0]])

    def error(model):
        return np.linalg.norm(difference @ (model.frequency_response(BETWEEN) - system.frequency_response(BETWEEN)))

    assert error(stated.model) < 0.2 * error(ignored.model)


def test_each_input_has_its_own_noise():
    g = np.random.default_rng(4)
    system = random_system(g, 3, 2, 2, 1.0)
    omega = np.linspace(0.05, 3.1, 400)
    truth = system.frequency_response(omega)
    sigma = np.ones(truth.shape) * 1e-3
    sigma[:200, :, 0] = 0.5
    sigma[200:, :, 1] = 0.5
    noise = sigma / np.sqrt(2) * (g.standard_normal(truth.shape) + 1j * g.standard_normal(truth.shape))
    data, z = FrequencyResponse(omega, truth + noise, (0.0,), 1.0, sigma**2), np.exp(1j * omega)

    def error(weighting):
        b, d = input_matrices(system.a, system.c, z, data.response, Noise.of(data, weighting))
        return relative_error(StateSpace(system.a, b, system.c, d, 1.0), system, BETWEEN)

    assert error("variance") < 0.1 * error("equal")


@pytest.mark.parametrize("stability", ["projection", "maciejowski"])
def test_models_are_kept_stable(stability):
    g = np.random.default_rng(5)
    poles = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    system = StateSpace(0.999 * poles, [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]], 1.0)
    unstable = 0
    for _ in range(12):
        data = noisy(system, np.linspace(0.05, 3.1, 60), np.full(60, 3.0), g)
        free = FrequencySubspace(order=6, block_rows=12).estimate(data)
        kept = FrequencySubspace(order=6, block_rows=12, stability=stability).estimate(data)
        unstable += not free.model.stable
        assert bool(free.outcome.advice) == (not free.model.stable)
        assert kept.model.stable
    assert unstable > 0


def test_projection_leaves_a_stable_model_alone():
    _, data = measured()
    free = FrequencySubspace(order=4).estimate(data).model
    assert free.stable
    assert np.array_equal(FrequencySubspace(order=4, stability="projection").estimate(data).model.a, free.a)


def test_errors_are_those_of_the_model():
    _, data = measured()
    estimate = FrequencySubspace(order=3).estimate(data)
    errors = np.linalg.norm(estimate.model.frequency_response(data.frequencies) - data.response, axis=(1, 2))
    assert estimate.max_error == pytest.approx(errors.max())
    assert estimate.rms_error == pytest.approx(np.sqrt(np.mean(errors**2)))
    assert estimate.relative_error == pytest.approx(np.linalg.norm(errors) / np.linalg.norm(data.response))


def test_b_and_d_are_the_best_for_this_a_and_c():
    _, data = measured(deviation=0.3 * np.exp(np.linspace(0, 2, 200)))
    model = FrequencySubspace(order=3).estimate(data).model

    def cost(b, d):
        errors = StateSpace(model.a, b, model.c, d, 1.0).frequency_response(data.frequencies) - data.response
        return np.sum(abs(errors) ** 2 / data.variance)

    least, g = cost(model.b, model.d), np.random.default_rng(0)
    for _ in range(20):
        assert cost(model.b + 1e-3 * g.standard_normal((3, 2)), model.d + 1e-3 * g.standard_normal((3, 2))) > least


def test_the_order_is_chosen_on_held_out_lines():
    _, data = measured(order=6, deviation=0.01, count=120)
    estimate = FrequencySubspace(max_order=10).estimate(data)
    assert estimate.model.order == 6
    assert [trial.order for trial in estimate.orders] == list(range(1, 11))
    held_out = np.array([trial.held_out_rms_error for trial in estimate.orders])
    assert held_out[5] < 0.2 * held_out[4]
    used, others = data.lines(slice(0, None, 2)), data.lines(slice(1, None, 2))
    again = FrequencySubspace(order=6, block_rows=estimate.block_rows, weighting="variance").estimate(used)
    errors = np.linalg.norm(again.model.frequency_response(others.frequencies) - others.response, axis=(1, 2))
    assert held_out[5] == pytest.approx(np.sqrt(np.mean(errors**2)), rel=0.05)


def test_the_order_is_where_the_singular_values_fall():
    _, data = measured(order=6, deviation=0.01, count=120)
    estimate = FrequencySubspace(max_order=10, order_rule="singular_values").estimate(data)
    assert estimate.model.order == 6
    assert estimate.orders == ()


def test_the_order_of_noise_free_data():
    system = random_system(np.random.default_rng(9), 5, 2, 1, 1.0)
    for rule in ("held_out", "singular_values"):
        estimate = FrequencySubspace(order_rule=rule).estimate(exact(system, np.linspace(0.01, 3.1, 60)))
        assert estimate.model.order == 5
        assert estimate.relative_error < 1e-10


def test_a_higher_order_than_the_data_have_is_pointed_out():
    system = random_system(np.random.default_rng(9), 2, 1, 1, 1.0)
    estimate = FrequencySubspace(order=4).estimate(exact(system, np.linspace(0.01, 3.1, 60)))
    assert "order 2 only" in estimate.outcome.advice
    assert estimate.relative_error < 1e-9


def test_a_constant_response_has_no_dynamics():
    data = FrequencyResponse(np.linspace(0.1, 3, 20), np.full((20, 1, 1), 2.0), (0.0,), 1.0)
    estimate = FrequencySubspace(order=1).estimate(data)
    assert estimate.relative_error < 1e-12


@pytest.mark.parametrize(
    ("method", "error", "field"),
    [
        (FrequencySubspace(order=4, block_rows=4), RangeError, "block_rows"),
        (FrequencySubspace(order=4, block_rows=40), NotIdentifiableError, "frequencies"),
        (FrequencySubspace(order=30), NotIdentifiableError, "frequencies"),
        (FrequencySubspace(order=0), RangeError, "order"),
        (FrequencySubspace(order=2, block_rows=-1), RangeError, "block_rows"),
        (FrequencySubspace(order=2, weighting="variance"), MisuseError, "weighting"),
        (FrequencySubspace(order=2, centre=4.0), RangeError, "centre"),
        (FrequencySubspace(max_order=12), NotIdentifiableError, "frequencies"),
    ],
)
def test_misuse(method, error, field):
    system = random_system(np.random.default_rng(0), 2, 1, 1, 1.0)
    with pytest.raises(error) as raised:
        method.estimate(exact(system, np.linspace(0.1, 3.0, 40)))
    assert raised.value.field == field


@pytest.mark.parametrize(
    ("response", "variance", "text"),
    [
        (np.zeros(5), None, "zero at every frequency"),
        (np.full(5, 1e200), None, "other units"),
        (np.full(5, 1e-200), None, "other units"),
        (np.ones(5), [1.0, 1.0, 1.0, 1.0, 1e-200], "differ by more"),
    ],
)
def test_values_that_cannot_be_computed_with(response, variance, text):
    data = FrequencyResponse(np.linspace(0.1, 3, 5), response, (0.0,), 1.0, variance)
    with pytest.raises(RangeError, match=text):
        FrequencySubspace(order=1).estimate(data)


def test_the_model_scales_with_the_units_of_the_response():
    _, data = measured()
    scaled = FrequencyResponse(data.frequencies, 1e60 * data.response, (0.0,), 1.0, 1e120 * data.variance)
    one, other = (FrequencySubspace(order=4).estimate(d).model for d in (data, scaled))
    assert np.allclose(other.frequency_response(BETWEEN), 1e60 * one.frequency_response(BETWEEN), rtol=1e-8)


def test_the_table_of_a_stated_order():
    _, data = measured(count=120)
    estimate = FrequencySubspace(order=4, order_table=True, max_order=6).estimate(data)
    assert estimate.model.order == 4
    assert [trial.order for trial in estimate.orders] == [1, 2, 3, 4, 5, 6]
    assert FrequencySubspace(order=4).estimate(data).orders == ()
