"""Maximum likelihood from synchronised periodic data: exactness, derivatives, bounds that are reached, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.affine_plant import AffinePlant, with_constant
from benchmarks.wind_turbine_plant import PLANT, SIZES, THETA, aligned, cramer_rao, disturbed, noise_free
from benchmarks.wind_turbine_plant import validation_fits as fits
from identification.along import simulate_along
from identification.errors import MisuseError, NotIdentifiableError, ShapeError
from identification.lti.rational_fit import RationalFit
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord
from identification.spectral.periodic_average import PeriodicAverage
from identification.varying.eigenvalues import eigenvalue_covariance, eigenvalues
from identification.varying.harmonic_blocks import HarmonicBlocks
from identification.varying.harmonic_noise import harmonic_noise
from identification.varying.periodic_likelihood import PeriodicLikelihood
from identification.varying.rates import variance_accounted_for
from identification.varying.records import VaryingRecord, steady_periods
from identification.varying.stacks import StackSizes, balanced
from tests.identification.varying.models import output_along, periodic_record, random_model

SAMPLES = 10_000


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([(24, 6), (21, 7), (30, 30), (12, 1)]), st.integers(1, 3))
def test_blocks_give_the_steady_state_and_its_derivatives(seed: int, periods: tuple[int, int], order: int) -> None:
    generator = np.random.default_rng(seed)
    model = random_model(generator, order, 2, 2, 2)
    sizes = StackSizes.of(model.matrices)
    theta = sizes.join(model.matrices)
    record = periodic_record(model, generator, *periods, periods=20 + 800 // periods[0])
    one = slice(0, periods[0])
    blocks = HarmonicBlocks(sizes, record.input[one], with_constant(record.scheduling[one]), periods[1])
    output, jacobian = blocks.output_and_jacobian(theta)
    assert np.allclose(output, np.fft.fft(record.output[-periods[0] :], axis=0)[blocks.lines], atol=1e-9)
    assert np.allclose(output, blocks.output(theta), atol=1e-10)
    direction = generator.standard_normal(sizes.size)
    difference = blocks.output(theta + 1e-6 * direction) - blocks.output(theta - 1e-6 * direction)
    assert np.allclose(difference / 2e-6, jacobian @ direction, atol=1e-5 * abs(jacobian @ direction).max())
    assert np.allclose(jacobian @ sizes.similarity_tangent(theta), 0, atol=1e-8 * abs(jacobian).max())
    together = np.concatenate([blocks.lines, -blocks.lines]) % periods[0]
    assert set(together) == set(range(periods[0]))
    assert blocks.stable(theta)
    identity = np.concatenate([np.eye(order)[None], np.zeros((2, order, order))])
    for size, stable in ((0.99, True), (-1.01, False)):
        assert blocks.stable(sizes.join((size * identity, model.b, model.c, model.d))) is stable


def test_balancing_changes_the_basis_only() -> None:
    model = random_model(np.random.default_rng(7), 3, 2, 2, 2)
    points, omega = np.zeros((1, 2)), np.linspace(0, np.pi, 7)
    same = AffinePlant(*balanced(model.matrices))
    assert np.allclose(same.frequency_response(points, omega), model.frequency_response(points, omega))


@pytest.mark.parametrize("seed", range(4))
def test_noise_free_data_give_the_model_back(seed: int) -> None:
    generator = np.random.default_rng(seed)
    model = random_model(generator, 1 + seed % 3, 1 + seed % 2, 1 + seed // 2, 1 + seed % 2)
    record = periodic_record(model, generator, 120, 12, 12)
    estimate = PeriodicLikelihood().estimate(record, model.order)
    u, p = generator.standard_normal((500, model.n_inputs)), generator.uniform(-1, 1, (500, model.n_scheduling))
    y = model.simulate(u, p)
    assert np.abs(output_along(estimate.model, u, p) - y).max() < 1e-6 * np.abs(y).max()
    assert estimate.outcome.ok


def test_noise_between_the_harmonics_is_that_on_them() -> None:
    record = replace(noise_free("multisine"), output=0 * noise_free("multisine").output)
    noise = harmonic_noise(steady_periods(disturbed(record, 0.5, True, np.random.default_rng(1)), 1))
    z = np.exp(-2j * np.pi * np.arange(500) / 500)
    shape = abs((1 + 0.5 * z) / (1 - 0.8 * z)) ** 2
    expected = 0.25 * 500 / 99 * shape / shape.mean()
    ratio = noise.covariance[:, 0, 0].real / expected
    assert noise.degrees_of_freedom == 98
    assert ratio.mean() == pytest.approx(1, abs=0.03)
    assert ratio.std() < 0.15


@pytest.mark.parametrize("coloured", [False, True])
def test_the_bound_is_reached(coloured: bool) -> None:
    generator = np.random.default_rng(20 + coloured)
    clean, runs = noise_free("multisine", SAMPLES), 80
    covariance, chart = cramer_rao(0.1, coloured, SAMPLES)
    estimates = [
        PeriodicLikelihood(drop_periods=1).estimate(disturbed(clean, 0.1, coloured, generator), 2) for _ in range(runs)
    ]
    errors = np.array([aligned(estimate.model) - THETA for estimate in estimates]) @ chart
    information = np.linalg.inv(chart.T @ covariance @ chart)
    ratio = np.mean(np.einsum("ri,ij,rj->r", errors, information, errors)) / SIZES.free
    assert ratio == pytest.approx(1.03, abs=4 * np.sqrt(2 / (runs * SIZES.free)))
    truth = eigenvalue_covariance(PLANT.model(covariance))[0, 0]
    stated = np.mean([eigenvalue_covariance(estimate.model)[0, 0] for estimate in estimates], axis=0)
    assert np.allclose(np.sqrt(np.diag(stated)), np.sqrt(np.diag(truth)), rtol=0.1)
    values = np.array([eigenvalues(estimate.model)[0].imag.max() for estimate in estimates])
    assert values.std() == pytest.approx(np.sqrt(truth[1, 1]), rel=4 / np.sqrt(2 * runs))
    assert np.mean([estimate.tests[0].p_value for estimate in estimates]) == pytest.approx(0.5, abs=0.15)


def test_the_wind_turbine_is_fitted_as_well_as_in_the_paper() -> None:
    generator = np.random.default_rng(3)
    clean = noise_free("multisine")
    models = [PeriodicLikelihood().estimate(disturbed(clean, 0.06, False, generator), 2).model for _ in range(5)]
    assert fits(models).mean() > 99.995


def test_the_stated_deviation_of_a_simulated_output_is_that_over_runs() -> None:
    generator = np.random.default_rng(4)
    clean = noise_free("multisine", SAMPLES)
    estimates = [PeriodicLikelihood(1).estimate(disturbed(clean, 0.1, False, generator), 2) for _ in range(60)]
    u, p = clean.input[:200], clean.scheduling[:200]
    spread = np.std([output_along(estimate.model, u, p) for estimate in estimates], axis=0)[5:, 0]
    stated = simulate_along(estimates[0].model, u, p).deviation[5:, 0]
    assert np.median(spread / stated) == pytest.approx(1, abs=0.2)


def test_local_and_varying_experiments_of_one_plant_agree_within_their_covariances() -> None:
    generator = np.random.default_rng(5)
    varying = PeriodicLikelihood(1).estimate(disturbed(noise_free("multisine"), 0.1, False, generator), 2).model
    omega = np.linspace(0.3, 2.8, 6)
    for point in (-0.6, 0.5):
        u = noise_free("multisine").input[:SAMPLES]
        y = PLANT.simulate(u, np.full((SAMPLES, 1), point)) + 0.1 * generator.standard_normal((SAMPLES, 1))
        measured = PeriodicAverage(drop_periods=1).estimate(TimeRecord(u[:, 0], y[:, 0], 1.0, (point,), 500))
        structure = RationalStructure(2, 2, sample_time=1.0)
        local = RationalFit().estimate(structure, measured).model
        gradient = structure.plant_gradient(local.zeta, omega)
        parts = np.stack([gradient.real, gradient.imag], axis=-1)
        of_local = np.einsum("afi,ab,bfj->fij", parts, local.covariance, parts)
        at = np.array([[point]])
        difference = varying.frequency_response(at, omega)[0, :, 0, 0]
        difference = difference - structure.plant_response(local.zeta, omega)
        d = np.stack([difference.real, difference.imag], axis=-1)
        of_varying = varying.response_covariance(at, omega)[0, :, 0, 0]
        statistic = np.einsum("fi,fij,fj->f", d, np.linalg.inv(of_local + of_varying), d)
        assert statistic.max() < 16
        assert statistic.mean() > 0.05


def test_too_low_an_order_is_seen() -> None:
    generator = np.random.default_rng(6)
    record = periodic_record(random_model(generator, 3), generator, 120, 12, 12, noise=0.001)
    estimate = PeriodicLikelihood(more_starts=0).estimate(record, 1)
    assert estimate.tests[0].p_value < 1e-6
    assert "higher order" in estimate.outcome.advice


def test_a_start_of_another_method_is_taken() -> None:
    generator = np.random.default_rng(8)
    model = random_model(generator)
    record = periodic_record(model, generator, 120, 12, 12, noise=0.01)
    unstable = replace(model, a=3 * model.a)
    for start in (model, unstable):
        estimate = PeriodicLikelihood().estimate(record, 2, start=start.model())
        assert estimate.outcome.ok
        assert estimate.tests[0].p_value > 1e-3
    assert variance_accounted_for(record.output, output_along(estimate.model, record.input, record.scheduling)) > 99.9
    with pytest.raises(ShapeError, match="the start has the sizes"):
        PeriodicLikelihood().estimate(record, 3, start=model.model())


def test_misuse_is_refused() -> None:
    clean = noise_free("multisine", SAMPLES)
    t = np.arange(SAMPLES)
    slow = np.cos(2 * np.pi * t / 10.1)
    with pytest.raises(MisuseError, match="not a whole number"):
        PeriodicLikelihood().estimate(VaryingRecord(clean.input, clean.output, slow, 1.0, 500), 2)
    with pytest.raises(MisuseError, match="record at least two"):
        PeriodicLikelihood().estimate(
            VaryingRecord(clean.input[:900], clean.output[:900], clean.scheduling[:900], 1.0, 500), 2
        )
    sine = np.cos(2 * np.pi * t / 500)
    with pytest.raises(NotIdentifiableError, match="excite more lines"):
        PeriodicLikelihood().estimate(VaryingRecord(sine, clean.output, clean.scheduling, 1.0, 500), 2)
    with pytest.raises(NotIdentifiableError, match="20 real numbers for 23 parameters"):
        PeriodicLikelihood().estimate(periodic_record(PLANT, np.random.default_rng(1), 20, 10, 40), 3)
