"""The simulated plant is the one that the truth describes, though the two share no code."""

import numpy as np
import pytest

from app.demo import task
from app.demo.plant import AirHeater
from identification.simulation import simulate


@pytest.mark.parametrize("velocity", [0.0, 3.0, 8.0])
def test_without_draught_it_is_the_true_model(velocity: float) -> None:
    power = np.random.default_rng(3).normal(size=300)
    quiet = AirHeater(shock_variance=0.0).measure(velocity, power, np.random.default_rng(1))
    zeta = task.true_model().coefficients([(velocity,)])[0]
    np.testing.assert_allclose(quiet, simulate(task.STRUCTURE, zeta, power), atol=1e-10)


@pytest.mark.parametrize("velocity", [0.0, 8.0])
def test_the_draught_has_the_stated_variance_and_memory_from_the_first_sample(velocity: float) -> None:
    memory = 0.7 - 0.08 * velocity
    generator = np.random.default_rng(4)
    records = np.array([AirHeater().measure(velocity, np.zeros(6), generator) for _ in range(4000)])
    np.testing.assert_allclose(records.var(axis=0), 0.5 / (1 - memory**2), rtol=0.1)
    neighbours = np.mean(records[:, 1:] * records[:, :-1]) / records.var()
    assert neighbours == pytest.approx(memory, abs=0.03)


def test_the_same_generator_measures_the_same() -> None:
    power = np.ones(20)
    one, other = (AirHeater().measure(1.0, power, np.random.default_rng(9)) for _ in range(2))
    np.testing.assert_array_equal(one, other)
