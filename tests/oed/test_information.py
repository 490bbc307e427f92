"""Information per unit of energy and per sample, against what simulated records say."""

from dataclasses import replace

import numpy as np
import pytest

from identification.errors import MisuseError
from identification.lti.likelihood import prediction_errors
from identification.models.model import Model
from identification.signals import TimeRecord
from identification.simulation import simulate
from oed.information import noise_information, require_stable, sensitivity, sensitivity_moments
from tests.support.random_models import paper_model, random_model

SEEDS = pytest.mark.parametrize("seed", range(6))


def numerical_information(model: Model, point: float, input: np.ndarray, repeats: int) -> np.ndarray:
    """Σ_t ψ ψᵀ / σ_e² for θ in the steady state of a periodic input, from the gradient of the prediction errors."""
    transfer = model.dependence.matrix([[point]])[0]
    zeta = transfer @ model.theta
    u = np.tile(input, repeats)
    output = simulate(model.structure, zeta, u)
    record = TimeRecord(u, output, model.structure.sample_time or 1.0, (point,))
    _, gradient = prediction_errors(model.structure, zeta, record)
    last = gradient[-len(input) :] @ transfer
    return np.asarray(last.T @ last / model.noise_variance)


@SEEDS
def test_lines_give_the_information_that_a_record_shows(seed: int) -> None:
    model, rng = random_model(np.random.default_rng(seed)), np.random.default_rng(seed)
    step = model.structure.sample_time or 1.0
    samples, lines = 64, np.array([0, 3, 11, 32])
    amplitudes = rng.uniform(0.5, 2, size=4)
    phases = np.where((lines == 0) | (lines == 32), 0.0, rng.uniform(0, 6, size=4))
    t = np.arange(samples)
    u = (amplitudes[:, None] * np.cos(2 * np.pi * lines[:, None] * t / samples + phases[:, None])).sum(axis=0)
    energies = samples * amplitudes**2 * np.where((lines == 0) | (lines == 32), 1.0, 0.5)
    assert energies.sum() == pytest.approx(u @ u)
    k = model.plant_size
    a = sensitivity(model, [[1.0]], 2 * np.pi * lines / (samples * step))[0]
    expected = ((a.T * energies) @ a.conj()).real
    assert numerical_information(model, 1.0, u, 12)[:k, :k] == pytest.approx(
        expected, rel=1e-6, abs=1e-9 * expected.max()
    )


@SEEDS
def test_moments_are_what_fir_filtered_noise_tells(seed: int) -> None:
    """A unit pulse as the input has all moments in its correlation with itself; the rest follows by shifting."""
    model = random_model(np.random.default_rng(seed))
    step = model.structure.sample_time or 1.0
    moments = sensitivity_moments(model, [[0.5]], 4, step)[0]
    omega = (np.arange(20000) + 0.5) * np.pi / 20000
    a = sensitivity(model, [[0.5]], omega / step)[0]
    for lag in range(5):
        direct = ((a.T * np.cos(lag * omega)) @ a.conj()).real / len(omega)
        assert moments[lag] == pytest.approx(direct, rel=1e-6, abs=1e-9 * abs(moments).max())


@SEEDS
def test_noise_information_is_the_mean_of_the_gradient_in_a_long_record(seed: int) -> None:
    model = random_model(np.random.default_rng(seed + 50))
    transfer = model.dependence.matrix([[0.5]])[0]
    zeta = transfer @ model.theta
    n = 200_000
    noise = np.random.default_rng(seed).normal(size=n) * np.sqrt(model.noise_variance)
    output = simulate(model.structure, zeta, np.zeros(n), noise)
    _, gradient = prediction_errors(
        model.structure, zeta, TimeRecord(np.zeros(n), output, 1.0 * (model.structure.sample_time or 1), (0.5,))
    )
    k = model.plant_size
    columns = (gradient @ transfer)[:, k:]
    expected = columns.T @ columns / n / model.noise_variance
    given = noise_information(model, [[0.5]])[0]
    assert given.shape == (model.dependence.size - k,) * 2
    if given.size:
        assert given == pytest.approx(expected, rel=0.05, abs=0.02 * given.max())


def test_many_points_in_parts_are_the_same_as_each_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    points = np.linspace(0, 8, 7)[:, None]
    whole = sensitivity_moments(paper_model(), points, 3, 1.0)
    monkeypatch.setattr("oed.information.PRODUCTS_AT_ONCE", 2**12)
    assert sensitivity_moments(paper_model(), points, 3, 1.0) == pytest.approx(whole, rel=1e-12)


def test_an_autoregressive_noise_model_by_hand() -> None:
    """H = 1/(1 + d q): the information about d is 1/(1 − d²) per sample."""
    given = noise_information(paper_model(), [[2.0]])[0]
    d = -0.7 + 0.08 * 2
    assert given == pytest.approx(np.array([[1, 2], [2, 4]]) / (1 - d**2))


def test_first_order_plant_by_hand() -> None:
    model = paper_model()
    a = sensitivity(model, [[2.0]], np.array([0.3]))[0, 0]
    q = np.exp(-0.3j)
    pole, gain, noise = 1 - 0.7 * q, 8.0, 1 - 0.54 * q
    by_b = q / pole * noise / np.sqrt(0.5)
    by_a = -gain * q / pole**2 * q * noise / np.sqrt(0.5)
    assert a == pytest.approx(np.array([by_a, 2 * by_a, by_b, 2 * by_b]))


def test_an_unstable_point_is_named() -> None:
    model = paper_model((-1.05, 0.1, 10.0, -1.0, -0.7, 0.08))
    with pytest.raises(MisuseError, match=r"unstable at the operating point \(0\)"):
        require_stable(model, [[0.0], [1.0]])
    require_stable(model, [[1.0], [2.0]])


def test_a_pole_on_the_unit_circle_is_refused_for_smooth_spectra() -> None:
    model = paper_model((-0.99999999, 0.1, 10.0, -1.0, -0.7, 0.08))
    with pytest.raises(MisuseError, match="close to the unit circle"):
        sensitivity_moments(model, [[0.0]], 3, 1.0)


def test_continuous_time_sensitivity_scales_with_the_noise() -> None:
    model = paper_model()
    structure = replace(model.structure, n_k=0, n_d=0, sample_time=None)
    dependence = replace(model.dependence, bases=model.dependence.bases[:2])
    slow = Model(structure, dependence, np.array([1.0, 0.0, 3.0, 0.0]), np.eye(4), 4.0)
    a = sensitivity(slow, [[0.0]], np.array([2.0]))[0, 0]
    assert a[2] == pytest.approx(1 / (2j + 1) / 2)
    assert a[0] == pytest.approx(-3 / (2j + 1) ** 2 / 2)
