"""Rational fits: exact on noise-free responses, in any units, with what cannot be fitted refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.lti.rational_fit import RationalFit, relative_error
from identification.models.model import LocalModel
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse

RELATIVE = RationalFit(weighting="relative")


def random_poles(generator: np.random.Generator, order: int) -> np.ndarray:
    pairs = int(generator.integers(0, order // 2 + 1))
    size, damping = 10 ** generator.uniform(-1, 1, pairs), generator.uniform(0.02, 0.9, pairs)
    upper = size * (-damping + 1j * np.sqrt(1 - damping**2))
    return np.concatenate([upper, upper.conj(), -(10 ** generator.uniform(-1, 1, order - 2 * pairs))])


def random_continuous(generator: np.random.Generator, delay: bool = False) -> tuple[RationalStructure, FloatArray]:
    n_a = int(generator.integers(0, 4 if delay else 7))
    n_b = int(generator.integers(0, n_a + 2))
    zeros = -(10 ** generator.uniform(-1, 1, n_b)) * generator.choice([1, 1, -1], n_b)
    b = np.atleast_1d(np.poly(zeros)) * generator.choice([-3.0, 0.5])
    a = np.atleast_1d(np.poly(random_poles(generator, n_a)).real)[1:]
    tau = [10 ** generator.uniform(-2, 0.3)] if delay else []
    return RationalStructure(n_a, n_b, delay=delay), np.concatenate([a, b, tau])


def random_discrete(generator: np.random.Generator) -> tuple[RationalStructure, FloatArray]:
    n_a, n_b, n_k = (int(generator.integers(0, top)) for top in (7, 5, 3))
    a = np.atleast_1d(np.poly(np.exp(0.3 * random_poles(generator, n_a))).real)[1:]
    return RationalStructure(n_a, n_b, n_k, sample_time=0.3), np.concatenate([a, generator.normal(size=n_b + 1)])


def lines(structure: RationalStructure) -> FloatArray:
    return np.linspace(0.02, np.pi / 0.3 - 0.05, 100) if structure.is_discrete else np.geomspace(0.01, 50, 100)


def response(structure: RationalStructure, zeta: FloatArray, omega: FloatArray) -> FrequencyResponse:
    return FrequencyResponse(omega, structure.plant_response(zeta, omega), (0.0,), structure.sample_time)


@pytest.mark.parametrize("seed", range(25))
@pytest.mark.parametrize("draw", [random_continuous, random_discrete])
def test_noise_free_responses_are_recovered(draw, seed):
    structure, zeta = draw(np.random.default_rng(seed))
    data = response(structure, zeta, lines(structure))
    estimate = RELATIVE.estimate(structure, data)
    assert relative_error(estimate.model, data) < 1e-8
    assert estimate.fit_percent > 99.9999


@pytest.mark.parametrize("seed", range(8))
def test_noise_free_responses_with_a_delay_are_recovered(seed):
    structure, zeta = random_continuous(np.random.default_rng(seed), delay=True)
    data = response(structure, zeta, lines(structure))
    assert relative_error(RELATIVE.estimate(structure, data).model, data) < 1e-8


@pytest.mark.parametrize("seed", range(3))
def test_a_discrete_plant_with_a_delay_is_recovered(seed):
    plain, zeta = random_discrete(np.random.default_rng(seed))
    structure, tau = replace(plain, n_a=min(plain.n_a, 3), delay=True), 0.77
    zeta = np.concatenate([0.1 * zeta[: structure.n_a], zeta[plain.n_a :], [tau]])
    data = response(structure, zeta, lines(structure))
    assert relative_error(RELATIVE.estimate(structure, data).model, data) < 1e-8


@pytest.mark.parametrize("weighting", ["relative", "absolute"])
def test_ten_decades_with_spread_poles(weighting):
    poles = -2 * np.pi * np.geomspace(3e-3, 1e6, 8)
    structure = RationalStructure(8, 7)
    zeta = np.concatenate([np.poly(poles)[1:], 0.7 * np.poly(2.3 * poles[:-1])])
    data = response(structure, zeta, 2 * np.pi * np.geomspace(1e-3, 1e7, 200))
    model = RationalFit(weighting=weighting).estimate(structure, data).model
    assert relative_error(model, data) < 1e-10
    np.testing.assert_allclose(_poles(model), np.sort(poles), rtol=1e-6)


def _poles(model: LocalModel) -> FloatArray:
    return np.sort(model.structure.poles(model.zeta).real)


def test_a_narrow_band_at_a_megahertz_in_rad_per_second():
    structure, zeta = megahertz_resonances()
    data = response(structure, zeta, 2 * np.pi * np.linspace(0.97e6, 1.03e6, 150))
    model = RELATIVE.estimate(structure, data).model
    assert relative_error(model, data) < 1e-8
    np.testing.assert_allclose(model.zeta, zeta, rtol=1e-6)


def megahertz_resonances() -> tuple[RationalStructure, FloatArray]:
    poles = np.concatenate([2 * np.pi * f * np.array([-1e-3 + 1j, -1e-3 - 1j]) for f in (0.99e6, 1.01e6)])
    zeros = 2 * np.pi * 1e6 * np.array([-1e-3 + 1j, -1e-3 - 1j])
    return RationalStructure(4, 2), np.concatenate([np.poly(poles).real[1:], 1e9 * np.poly(zeros).real])


def test_the_covariance_does_not_depend_on_the_frequency_scale():
    structure, zeta = megahertz_resonances()
    omega = 2 * np.pi * np.linspace(0.97e6, 1.03e6, 150)
    data = noisy(response(structure, zeta, omega), 0.01, 3)
    one = RELATIVE.estimate(structure, data).model
    other = RELATIVE.estimate(replace(structure, frequency_scale=6e6), data).model
    ratio = 6e6 ** -np.array([1.0, 2, 3, 4, 2, 3, 4])
    np.testing.assert_allclose(other.zeta, one.zeta * ratio, rtol=1e-6)
    np.testing.assert_allclose(other.covariance, one.covariance * np.outer(ratio, ratio), rtol=1e-3)


def noisy(data: FrequencyResponse, level: float, seed: int, variance: bool = False) -> FrequencyResponse:
    """The data with circular noise of relative standard deviation `level`, its variance stated or not."""
    generator = np.random.default_rng(seed)
    noise = generator.normal(size=(2, len(data))) / np.sqrt(2)
    spread = level * abs(data.response)
    return replace(
        data,
        response=data.response + spread * (noise[0] + 1j * noise[1]),
        variance=spread**2 if variance else None,
    )


def test_a_rigid_body_needs_no_stability():
    structure, zeta = RationalStructure(2, 0), np.array([0.0, 0.0, 5.0])
    data = noisy(response(structure, zeta, np.geomspace(1, 1000, 60)), 0.01, 0, variance=True)
    free = RationalFit(stable=False).estimate(structure, data)
    assert free.outcome.ok
    assert abs(free.model.zeta[2] / 5 - 1) < 0.01
    held = RELATIVE.estimate(structure, data)
    assert np.all(structure.stable(held.model.zeta))


def test_stability_is_kept_even_when_the_response_is_not_of_a_stable_plant():
    structure, zeta = RationalStructure(2, 1), np.array([-1.0, 4.0, 1.0, 2.0])
    data = response(structure, zeta, np.geomspace(0.1, 30, 80))
    assert not structure.stable(zeta)
    assert structure.stable(RELATIVE.estimate(structure, data).model.zeta)
    free = RationalFit(weighting="relative", stable=False).estimate(structure, data)
    np.testing.assert_allclose(free.model.zeta, zeta, rtol=1e-8)


def test_too_high_an_order_is_reported_and_not_hidden():
    structure, zeta = RationalStructure(1, 0), np.array([2.0, 3.0])
    data = response(structure, zeta, np.geomspace(0.1, 30, 60))
    estimate = RELATIVE.estimate(RationalStructure(2, 1), data)
    assert estimate.outcome.status == "not_identifiable"
    assert relative_error(estimate.model, data) < 1e-8


def test_the_line_at_zero_alone_gives_a_gain():
    data = FrequencyResponse([0.0], [2.5], (0.0,), 0.1, [0.02])
    estimate = RationalFit().estimate(RationalStructure(0, 0, sample_time=0.1), data)
    assert estimate.model.zeta == pytest.approx([2.5])
    assert estimate.model.covariance[0, 0] == pytest.approx(0.01)
    with pytest.raises(NotIdentifiableError, match="1 real numbers for 2"):
        RationalFit().estimate(RationalStructure(0, 1, sample_time=0.1), data)


def test_what_cannot_be_fitted_is_refused():
    data = FrequencyResponse([1.0, 2.0, 3.0], [1.0, 0.5, 0.2 - 1j], (0.0,), 0.1)
    with pytest.raises(MisuseError, match="noise model"):
        RELATIVE.estimate(RationalStructure(1, 0, n_c=1, sample_time=0.1), data)
    with pytest.raises(MisuseError, match="no variance"):
        RationalFit().estimate(RationalStructure(1, 0, sample_time=0.1), data)
    with pytest.raises(MisuseError, match="sample time"):
        RELATIVE.estimate(RationalStructure(1, 0), data)
    with pytest.raises(NotIdentifiableError):
        RELATIVE.estimate(RationalStructure(4, 3, sample_time=0.1), data)
    with pytest.raises(RangeError, match="zero at every"):
        RELATIVE.estimate(RationalStructure(1, 0, sample_time=0.1), replace(data, response=np.zeros(3)))
    with pytest.raises(NotIdentifiableError, match="and the noise"):
        RELATIVE.estimate(RationalStructure(3, 2, sample_time=0.1), data)
    poor = replace(data, variance=np.ones(3), variance_degrees_of_freedom=2.0)
    with pytest.raises(MisuseError, match="four periods"):
        RationalFit().estimate(RationalStructure(1, 0, sample_time=0.1), poor)


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 10**6), gain=st.sampled_from([-1e-9, 1e-3, -1.0, 1e6]), speed=st.sampled_from([1e-6, 1e-2, 1e5])
)
def test_units_of_signals_and_time_change_nothing_else(seed, gain, speed):
    generator = np.random.default_rng(seed)
    structure = RationalStructure(2, 1)
    size, damping = 10 ** generator.uniform(-0.5, 0.5), generator.uniform(0.1, 0.8)
    zeta = np.array([2 * damping * size, size**2, 1.0, 3.0])
    data = noisy(response(structure, zeta, np.geomspace(0.01, 50, 60)), 0.02, seed)
    scaled = replace(data, frequencies=speed * data.frequencies, response=gain * data.response)
    one, other = RELATIVE.estimate(structure, data), RELATIVE.estimate(structure, scaled)
    factors = np.array([speed, speed**2, gain * speed, gain * speed**2])
    np.testing.assert_allclose(other.model.zeta, factors * one.model.zeta, rtol=1e-5)
    np.testing.assert_allclose(
        other.model.covariance, np.outer(factors, factors) * one.model.covariance, rtol=1e-3, atol=0
    )
    assert other.model.noise_variance == pytest.approx(one.model.noise_variance, rel=1e-6)


def test_the_estimate_is_the_same_every_time_and_in_every_order_of_the_lines():
    structure, zeta = random_continuous(np.random.default_rng(4))
    data = noisy(response(structure, zeta, lines(structure)), 0.02, 1, variance=True)
    mixed = np.random.default_rng(2).permutation(len(data))
    first, again = RationalFit().estimate(structure, data), RationalFit().estimate(structure, data)
    np.testing.assert_array_equal(first.model.zeta, again.model.zeta)
    shuffled = replace(
        data, frequencies=data.frequencies[mixed], response=data.response[mixed], variance=data.variance[mixed]
    )
    other = RationalFit().estimate(structure, shuffled)
    np.testing.assert_allclose(other.model.zeta, first.model.zeta, rtol=1e-4)
    assert [t.p_value for t in other.tests] == pytest.approx([t.p_value for t in first.tests], rel=1e-3)
