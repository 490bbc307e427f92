"""Noise-free responses are reproduced from the least number of lines [Akcay2008, Theorems 1 and 3]."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.subspace_exactness import run
from identification.errors import NotIdentifiableError
from identification.subspace.equidistant_subspace import EquidistantSubspace
from identification.subspace.frequency_subspace import FrequencySubspace
from tests.support.state_space import exact, random_system, relative_error

BETWEEN = np.linspace(0.001, 3.14, 300)


@pytest.mark.parametrize("order", range(1, 21))
def test_least_number_of_lines_and_four_decades(order):
    for row in run(range(order, order + 1), systems=2):
        assert row["largest"] < 1e-8, row


@given(
    seed=st.integers(0, 10**6),
    order=st.integers(1, 8),
    inputs=st.integers(1, 3),
    outputs=st.integers(1, 3),
    more=st.integers(0, 5),
    transition=st.sampled_from(["least_squares", "total_least_squares"]),
    weighting=st.sampled_from(["variance", "equal", "none"]),
)
@settings(max_examples=40, deadline=None)
def test_any_weighting_is_exact(seed, order, inputs, outputs, more, transition, weighting):
    g = np.random.default_rng(seed)
    system = random_system(g, order, inputs, outputs, 1.0)
    q = order + 1 + more
    count = order + q + more
    omega = np.pi * (np.arange(count) + g.uniform(0.1, 0.9, count)) / count
    data = exact(system, omega)
    variance = np.exp(g.uniform(-3, 3, data.response.shape))
    data = type(data)(omega, data.response, (0.0,), 1.0, variance)
    method = FrequencySubspace(order=order, block_rows=q, transition=transition, weighting=weighting)
    assert relative_error(method.estimate(data).model, system, BETWEEN) < 1e-8


def test_correlated_noise_is_exact_too():
    g = np.random.default_rng(2)
    system = random_system(g, 4, 2, 3, 1.0)
    omega = np.linspace(0.1, 3.0, 15)
    root = g.standard_normal((15, 6, 9)) + 1j * g.standard_normal((15, 6, 9))
    data = exact(system, omega)
    data = type(data)(omega, data.response, (0.0,), 1.0, covariance=root @ root.conj().swapaxes(1, 2))
    assert relative_error(FrequencySubspace(order=4).estimate(data).model, system, BETWEEN) < 1e-9


def test_one_input_and_output_without_axes():
    system = random_system(np.random.default_rng(5), 3, 1, 1, 1.0)
    omega = np.linspace(0.1, 3.0, 9)
    data = type(exact(system, omega))(omega, system.frequency_response(omega)[:, 0, 0], (0.0,), 1.0)
    estimate = FrequencySubspace(order=3).estimate(data)
    assert relative_error(estimate.model, system, BETWEEN) < 1e-10
    assert estimate.max_error < 1e-10
    assert estimate.relative_error < 1e-10


def test_both_parities_of_the_circle():
    system = random_system(np.random.default_rng(6), 5, 2, 2, 1.0)
    for omega in (np.pi * np.arange(9) / 8, 2 * np.pi * np.arange(9) / 17):
        estimate = EquidistantSubspace(order=5).estimate(exact(system, omega))
        assert relative_error(estimate.model, system, BETWEEN) < 1e-10


def test_the_order_of_lines_does_not_matter():
    g = np.random.default_rng(8)
    system = random_system(g, 3, 2, 2, 1.0)
    omega = np.linspace(0.0, 3.0, 12)
    shuffled = exact(system, omega).lines(g.permutation(12))
    assert relative_error(FrequencySubspace(order=3).estimate(shuffled).model, system, BETWEEN) < 1e-10


def test_fewer_lines_than_the_theorem_asks_for_are_refused():
    system = random_system(np.random.default_rng(0), 4, 1, 1, 1.0)
    data = exact(system, np.linspace(0.1, 3.0, 8))
    with pytest.raises(NotIdentifiableError, match="at least 9 lines") as raised:
        FrequencySubspace(order=4, block_rows=5).estimate(data)
    assert raised.value.field == "frequencies"
