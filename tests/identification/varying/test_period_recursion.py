"""A long scheduling period: the recursion through it, and that it stands in for blocks only where it may."""

import numpy as np
import pytest

from benchmarks.affine_plant import with_constant
from identification.varying import period_recursion
from identification.varying.harmonic_blocks import HarmonicBlocks
from identification.varying.period_recursion import PeriodRecursion, periodic_response
from identification.varying.stacks import StackSizes
from tests.identification.varying.models import random_model


@pytest.mark.parametrize("samples", [1, 2, 7, 30])
def test_the_recursion_closes_the_period(samples: int) -> None:
    generator = np.random.default_rng(samples)
    transition = 0.6 * generator.standard_normal((samples, 3, 3))
    forcing = generator.standard_normal((samples, 3, 2))
    x = PeriodRecursion(transition).solve(forcing)
    assert x.shape == forcing.shape
    assert np.allclose(transition @ x + forcing, np.roll(x, -1, axis=0), atol=1e-9 * abs(x).max())


@pytest.mark.parametrize("size", [1.0, 8.0])
def test_a_period_that_is_stated_longer_changes_nothing(size: float) -> None:
    generator = np.random.default_rng(3)
    model = random_model(generator, 2, 2, 2, 2)
    sizes = StackSizes.of(model.matrices)
    theta = sizes.join((size * model.a, model.b, model.c, model.d))
    u, p = generator.standard_normal((42, 2)), np.tile(generator.uniform(-1, 1, (6, 2)), (7, 1))
    short, long = (HarmonicBlocks(sizes, u, with_constant(p), period) for period in (6, 42))
    assert short.stable(theta) is long.stable(theta) is (size == 1.0)
    assert 2 * 6 <= short.largest_block < 2 * 42
    for of_short, of_long in zip(short.output_and_jacobian(theta), long.output_and_jacobian(theta), strict=True):
        at = {int(line): values for line, values in zip(short.lines, of_short, strict=True)}
        at |= {(42 - line) % 42: values.conj() for line, values in at.items()}
        expected = np.array([at[int(line)] for line in long.lines])
        assert np.allclose(of_long, expected, atol=1e-10 * abs(expected).max())
    assert np.allclose(long.output(theta), long.output_and_jacobian(theta)[0], rtol=1e-10)


def test_states_one_at_a_time_or_together(monkeypatch: pytest.MonkeyPatch) -> None:
    generator = np.random.default_rng(4)
    model = random_model(generator, 3, 1, 2, 1)
    u, p = generator.standard_normal((20, 2)), generator.uniform(-1, 1, (20, 1))
    response = periodic_response(model.matrices, u, with_constant(p))
    together = response.through()
    for at_once in (1, 2 * response.signals.size * 3):
        monkeypatch.setattr(period_recursion, "AT_ONCE", at_once)
        assert np.allclose(response.through(), together, rtol=1e-12)
