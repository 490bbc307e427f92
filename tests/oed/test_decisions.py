"""Decisions about effects: error rates, expected power, and the least distance between two effects."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import ncx2, norm

from identification.effects.delay import Delay
from identification.effects.lag import Lag
from identification.errors import MisuseError, RangeError
from identification.places.placed import placed
from oed.budget import within_energy
from oed.decisions import Demand, ErrorRates, conviction
from oed.design import design
from oed.hypothesis import Hypothesis, response_batch
from oed.problem import DesignProblem
from oed.spectra.lines import LineSpectra, LineSpectrum
from oed.spectra.multisines import Multisines
from oed.targets.effect_detection import EffectDetection
from oed.targets.effect_discrimination import EffectDiscrimination
from oed.targets.parameter_deviation import ParameterDeviation
from tests.support.oscillators import MODEL, SAMPLE_TIME

PLANT = replace(MODEL, noise_variance=1e-4)
POINTS = np.linspace(-1, 1, 5)[:, None]
LINES = LineSpectra(128)
SIGNALS = Multisines(128, (2.0, 6.0))


def problem(*targets: object, **options: object) -> DesignProblem:
    stated = {"model": PLANT, "points": POINTS, "family": LINES, "samples": 12800, "sample_time": SAMPLE_TIME}
    return DesignProblem(targets=tuple(targets), **{**stated, **options})  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize(("power", "level"), [(0.9, 0.05), (0.5, 0.01), (0.99, 0.1)])
def test_two_sided_error_rates(power: float, level: float, count: int) -> None:
    rates = ErrorRates(power, level, count)
    assert ncx2.sf(ncx2.ppf(1 - level, count, 1e-12), count, rates.noncentrality) == pytest.approx(power, abs=1e-6)
    assert rates.power_at(rates.noncentrality) == pytest.approx(power, abs=1e-9)


def test_one_sided_error_rates() -> None:
    rates = ErrorRates(0.9, 0.05, one_sided=True)
    assert norm.sf(norm.ppf(0.95), loc=np.sqrt(rates.noncentrality)) == pytest.approx(0.9)
    assert rates.power_at(rates.noncentrality) == pytest.approx(0.9)
    assert rates.noncentrality < ErrorRates(0.9, 0.05).noncentrality


def test_conviction_is_the_share_of_weights_above_95_per_cent() -> None:
    noise = np.random.default_rng(0).standard_normal((100_000, 2))
    apart = np.array([3.0, 1.0])
    difference = np.sum((noise + apart) ** 2, axis=1) - np.sum(noise**2, axis=1)
    weights = 1 / (1 + np.exp(-difference / 2))
    assert conviction(10.0) == pytest.approx(np.mean(weights > 0.95), abs=0.005)
    assert conviction(0.0) == 0.0


def test_the_expected_variance_has_the_other_parameters_free() -> None:
    factor = np.random.default_rng(1).normal(size=(5, 5)) * np.array([1, 1e3, 1e-3, 1, 10.0])[:, None]
    information = factor @ factor.T
    demand = Demand(Hypothesis(PLANT, suspected=placed(Lag(), 0, 1)), slice(4, 5), 0.2, ErrorRates(0.9, 0.05), "lag")
    found = demand.expected(information)
    assert found.variance == pytest.approx(np.linalg.inv(information)[4, 4], rel=1e-6)
    assert found.noncentrality == pytest.approx(0.04 / found.variance)
    information[:, 4] = information[4, :] = 0.0
    assert demand.expected(information).power == pytest.approx(0.05)
    assert not np.isfinite(demand.expected(information).variance)


def test_lines_for_a_detection_give_the_variance_asked_for() -> None:
    target = EffectDetection("lag", 0.02, power=0.8, level=0.01)
    result = design(problem(target))
    assert result.outcome.ok
    information = np.zeros((5, 5))
    with_lag = PLANT.plus(placed(Lag(), 0, 1, 0.0))
    for one in result.experiments:
        assert isinstance(one.spectrum, LineSpectrum)
        a = Hypothesis(with_lag).sensitivity([one.operating_point], one.spectrum.frequencies)[0]
        information += np.einsum("f,fi,fj->ij", one.spectrum.energies, a, a.conj()).real
    scale = 1 / np.sqrt(np.diagonal(information))
    inverse = np.linalg.pinv(information * np.outer(scale, scale), rcond=1e-10, hermitian=True)
    variance = inverse[4, 4] * scale[4] ** 2
    assert norm.sf(norm.ppf(0.99), loc=0.02 / np.sqrt(variance)) == pytest.approx(0.8, abs=1e-4)
    assert result.decisions[0][1].variance == pytest.approx(variance, rel=1e-6)
    assert [(one.what, one.index) for one in result.binding] == [("target", 0)]
    assert result.binding[0].multiplier == pytest.approx(1.0, rel=1e-3)


def test_an_effect_in_the_model_is_a_parameter_of_the_design() -> None:
    carrying = PLANT.plus(placed(Delay(), 0, 1, 0.02))
    theta = ParameterDeviation((0.05, 1.0, 1.0, 0.05))
    alone, together = design(problem(theta)), design(problem(theta, model=carrying))
    assert together.expected_covariance.shape == (5, 5)
    assert together.expected_covariance[0, 0] <= 0.05**2 * (1 + 1e-6)
    assert together.total_energy > alone.total_energy * (1 - 1e-4)
    asked = design(problem(theta, EffectDetection("delay", 0.001), model=carrying))
    amplitude = asked.expected_covariance[4, 4]
    assert amplitude == pytest.approx(0.001**2 / ErrorRates(0.9, 0.05, one_sided=True).noncentrality, rel=1e-3)
    assert asked.decisions[0][1].variance == pytest.approx(amplitude, rel=1e-6)


def test_the_designed_distance_is_what_is_left_after_the_best_imitation() -> None:
    """λ of delay against lag, found anew by minimising over θ and the lag with another algorithm."""
    result = design(problem(EffectDiscrimination("delay", "lag", 0.06, both_ways=False)))
    decision = result.decisions[0][1]
    assert decision.power == pytest.approx(0.9, abs=1e-4)
    truth = PLANT.plus(placed(Delay(), 0, 1, 0.06))
    imitating = PLANT.plus(placed(Lag(), 0, 1, 0.06))
    parts = []
    for one in result.experiments:
        assert isinstance(one.spectrum, LineSpectrum)
        batch = response_batch(PLANT, [one.operating_point], one.spectrum.frequencies)
        parts.append((batch, np.sqrt(one.spectrum.energies / 1e-4), truth.output(batch)))
    scale = np.abs(imitating.parameters)

    def distance(relative: np.ndarray) -> float:
        model = imitating.with_parameters(imitating.parameters + scale * relative)
        return float(sum(np.sum(np.abs(size * (y - model.output(batch))) ** 2) for batch, size, y in parts))

    least = minimize(distance, np.zeros(5), method="BFGS", options={"gtol": 1e-5}).fun
    assert decision.noncentrality == pytest.approx(least, rel=0.1)
    assert distance(np.zeros(5)) > 2 * least


def test_what_is_known_of_one_parameter_does_not_hide_what_is_missing_of_another() -> None:
    """In units that make the information about the first ten orders larger."""
    target = ParameterDeviation((1e-5, 1.0, None, None))
    found = design(problem(target, prior_information=np.diag([1.001e10, 0.0, 0.0, 0.0])))
    assert found.experiments
    assert not design(problem(target, prior_information=np.diag([1.001e10, 2.0, 0.0, 0.0]))).experiments


def test_both_ways_are_decided() -> None:
    result = design(problem(EffectDiscrimination("delay", "lag", 0.06)))
    assert [(one.demand.kind, one.demand.against) for _, one in result.decisions] == [
        ("delay", "lag"),
        ("lag", "delay"),
    ]
    assert min(one.power for _, one in result.decisions) == pytest.approx(0.9, abs=1e-4)
    assert all(0 < (one.conviction or 0) < 1 for _, one in result.decisions)


def test_the_best_decision_for_a_stated_energy() -> None:
    target = EffectDetection("cubic_stiffness", 0.5)
    asked = problem(target, family=SIGNALS)
    cheap, dear = within_energy(asked, 2e4), within_energy(asked, 4e4)
    assert 0.9 * 2e4 <= cheap.total_energy <= 2e4
    assert 0.9 * 4e4 <= dear.total_energy <= 4e4
    ratio = dear.decisions[0][1].noncentrality / cheap.decisions[0][1].noncentrality
    assert 1.6 < ratio < 2.4


def test_effects_that_make_no_sense() -> None:
    for make, words in (
        (lambda: EffectDetection("gremlins", 1.0), "no effect gremlins"),
        (lambda: EffectDetection("delay", -0.1), "this sign"),
        (lambda: EffectDetection("delay", 0.0), "not zero"),
        (lambda: EffectDetection("resonance", 0.1), "frequency, damping"),
        (lambda: EffectDetection("delay", 0.1, power=1.5), "between 0 and 1"),
        (lambda: EffectDetection("delay", 0.1, power=0.01), "exceed the level"),
        (lambda: EffectDiscrimination("delay", "delay", 0.1), "from itself"),
        (lambda: EffectDiscrimination("delay", "gremlins", 0.1), "no effect gremlins"),
    ):
        with pytest.raises(RangeError, match=words):
            make()
    with pytest.raises(RangeError, match="state the amplitude"):
        design(problem(EffectDiscrimination("delay", "lag")))
    with pytest.raises(MisuseError, match="candidate multisines"):
        design(problem(EffectDetection("cubic_stiffness", 1.0)))
    with pytest.raises(MisuseError, match="how or when was measured"):
        design(problem(EffectDetection("gain_drift", 1.0)))
