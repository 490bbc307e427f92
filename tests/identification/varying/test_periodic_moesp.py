"""Periodic MOESP: exact without noise, consistent with it, windows and excitation checked."""

import numpy as np
import pytest

from benchmarks.wind_turbine_plant import PLANT, disturbed, noise_free, validation_fits
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.varying.eigenvalues import eigenvalues
from identification.varying.periodic_likelihood import PeriodicLikelihood
from identification.varying.periodic_moesp import PeriodicMoesp
from identification.varying.rates import variance_accounted_for
from identification.varying.records import VaryingRecord
from tests.identification.varying.models import output_along, random_model

SAMPLES = 8000


@pytest.mark.parametrize(("seed", "n_y", "n_u"), [(1, 2, 1), (2, 2, 2), (3, 3, 2)])
def test_noise_free_data_give_the_model_back(seed: int, n_y: int, n_u: int) -> None:
    generator = np.random.default_rng(seed)
    model = random_model(generator, 2, 1, n_u, n_y)
    p = np.tile(generator.uniform(-1, 1, (20, 1)), (SAMPLES // 20, 1))
    u = generator.standard_normal((SAMPLES, n_u))
    record = VaryingRecord(u, model.simulate(u, p), p, 1.0)
    estimate = PeriodicMoesp().estimate(record, 2)
    fresh = generator.uniform(-1, 1, (SAMPLES, 1))
    y = model.simulate(u, fresh)
    assert variance_accounted_for(y, output_along(estimate.model, u, fresh)) > 100 - 1e-6
    assert "was chosen" in estimate.outcome.advice


def test_the_wind_turbine_with_a_constant_output_matrix() -> None:
    clean = noise_free("white")
    exact = PeriodicMoesp(varying_output=False).estimate(clean, 2)
    assert np.allclose(np.sort_complex(eigenvalues(exact.model)), np.sort_complex(PLANT.eigenvalues()), atol=1e-6)
    noisy = disturbed(clean, 0.06, False, np.random.default_rng(1))
    estimate = PeriodicMoesp(varying_output=False).estimate(noisy, 2)
    assert 99.9 < validation_fits([estimate.model])[0] < 100 - 1e-7


def test_a_basis_that_the_scheduling_does_not_determine_is_said() -> None:
    estimate = PeriodicMoesp().estimate(noise_free("white", SAMPLES), 2)
    assert "hardly determined" in estimate.outcome.advice


def test_it_starts_the_likelihood() -> None:
    generator = np.random.default_rng(2)
    start = PeriodicMoesp(varying_output=False).estimate(
        disturbed(noise_free("white", SAMPLES), 0.06, False, generator), 2
    )
    record = disturbed(noise_free("multisine", SAMPLES), 0.06, False, generator)
    refined = PeriodicLikelihood(1).estimate(record, 2, start.model)
    assert refined.outcome.ok
    assert refined.tests[0].p_value > 1e-3
    assert validation_fits([refined.model])[0] > validation_fits([start.model])[0]


@pytest.mark.parametrize("window", [1, 2, 11])
def test_windows_outside_the_period_and_the_order_are_refused(window: int) -> None:
    with pytest.raises(RangeError, match=rf"d = {window} must keep 10 ≥ d > 2"):
        PeriodicMoesp(window=window).estimate(noise_free("white", SAMPLES), 2)


def test_poor_excitation_short_records_and_free_scheduling_are_refused() -> None:
    clean = noise_free("white", SAMPLES)
    sine = np.cos(2 * np.pi * np.arange(SAMPLES) / 20)[:, None]
    with pytest.raises(NotIdentifiableError, match="too low a rank"):
        PeriodicMoesp().estimate(VaryingRecord(sine, PLANT.simulate(sine, clean.scheduling), clean.scheduling, 1.0), 2)
    with pytest.raises(NotIdentifiableError, match="record longer"):
        PeriodicMoesp().estimate(clean.part(0, 150), 2)
    free = np.random.default_rng(1).uniform(-1, 1, (SAMPLES, 1))
    with pytest.raises(MisuseError, match="scheduling does not repeat"):
        PeriodicMoesp().estimate(VaryingRecord(clean.input, clean.output, free, 1.0), 2)
