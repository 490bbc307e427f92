"""Promises: energies that can be had by hand, probabilities of draws that the design has not seen, and misuse."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, RangeError
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from oed.design import design
from oed.problem import DesignProblem
from oed.robust import Promise, clopper_pearson, meets, promised
from oed.spectra.fir import FirSpectra
from oed.spectra.lines import LineSpectra
from oed.spectra.multisines import Multisines
from oed.targets.parameter_deviation import ParameterDeviation
from oed.targets.response_deviation import ResponseDeviation
from tests.support.random_models import paper_model

DEVIATIONS = (0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3)


def gain(value: float, deviation: float, noise_variance: float) -> Model:
    """y = b u + e, b known to a deviation."""
    structure = RationalStructure(n_a=0, n_b=0, n_k=0, n_c=0, n_d=0, sample_time=1.0)
    dependence = ParameterDependence((SchedulingVariable("p", "1", 0.0, 1.0),), (ProductBasis((Polynomial(0),)),))
    return Model(structure, dependence, np.array([value]), np.array([[deviation**2]]), noise_variance)


def stated(model: Model, target: object, **options: object) -> DesignProblem:
    given = {"points": np.array([[0.5]]), "family": LineSpectra(64), "samples": 64}
    return DesignProblem(model, targets=(target,), **{**given, **options})  # type: ignore[arg-type]


@pytest.mark.parametrize("probability", [0.8, 0.95])
def test_a_relative_accuracy_is_promised_at_the_smallest_gain_that_is_likely(probability: float) -> None:
    """E = σ²/(δ b)², largest at small b: the promise needs b̂ − z s, however the spectra are parametrised."""
    problem = stated(gain(2.0, 0.2, 0.3), ResponseDeviation(((0.5,),), 0.5, 1.0, 0.02, count=2))
    found, kept = promised(problem, Promise(probability, pool=600, checked=300, seed=3))
    assert kept is not None
    at_estimate = design(problem).total_energy
    ratio = (2.0 / (2.0 - stats.norm.ppf(probability) * 0.2)) ** 2
    assert found.total_energy / at_estimate == pytest.approx(ratio, rel=0.04)
    assert kept.energy_at_estimate == pytest.approx(at_estimate)
    assert found.lower_bound == pytest.approx(at_estimate, rel=1e-3)
    assert kept.lowest - 0.02 <= probability <= kept.highest + 0.02
    assert kept.lowest < kept.kept / kept.checked < kept.highest


def test_the_noise_may_be_larger_than_was_estimated() -> None:
    deviation = 0.1
    problem = stated(gain(2.0, 1e-9, 0.3), ParameterDeviation((0.01,)))
    found, kept = promised(problem, Promise(0.95, deviation, pool=600, checked=100, seed=1))
    assert kept is not None
    freedom = 2 / deviation**2
    assert found.total_energy == pytest.approx(0.3 / 0.01**2 * stats.chi2.ppf(0.95, freedom) / freedom, rel=0.025)
    known, _ = promised(problem, Promise(0.95, pool=100, checked=100))
    assert known.total_energy == pytest.approx(0.3 / 0.01**2, rel=1e-3)


@pytest.mark.parametrize("family", [FirSpectra(4), LineSpectra(200)])
def test_the_example_of_the_paper_keeps_its_promise_where_the_estimate_alone_does_not(
    family: FirSpectra | LineSpectra,
) -> None:
    covariance = np.diag([0.006, 0.0008, 0.12, 0.02, 0.05, 0.01]) ** 2
    model = replace(paper_model(), covariance=covariance)
    problem = DesignProblem(model, np.arange(0.0, 9.0, 2.0)[:, None], (ParameterDeviation(DEVIATIONS),), family, 1000)
    found, kept = promised(problem, Promise(0.9, pool=200, checked=100, seed=5))
    assert kept is not None
    assert found.outcome.ok
    assert kept.highest >= 0.88
    assert kept.scenario_gap <= 1e-4
    rng = np.random.default_rng(77)
    truths = [replace(model, theta=rng.multivariate_normal(model.theta, covariance)) for _ in range(150)]
    alone = design(problem)
    assert np.mean([meets(problem, found, truth) for truth in truths]) >= 0.83
    assert np.mean([meets(problem, alone, truth) for truth in truths]) <= 0.7
    assert found.total_energy > alone.total_energy
    again, same = promised(problem, Promise(0.9, pool=200, checked=100, seed=5))
    assert (again.total_energy, same) == (found.total_energy, kept)


def test_what_is_known_is_enough_only_if_it_is_at_the_likely_parameters() -> None:
    target = ResponseDeviation(((0.5,),), 0.5, 1.0, 0.02, count=2)
    model = gain(2.0, 0.2, 0.3)
    enough_here = np.array([[1.001 / (0.02 * 2.0) ** 2]])
    problem = stated(model, target, prior_information=enough_here)
    assert design(problem).total_energy == 0
    found, kept = promised(problem, Promise(0.95, pool=200, checked=100, seed=2))
    assert kept is not None
    assert found.total_energy > 0
    assert kept.highest >= 0.93
    plenty, kept = promised(replace(problem, prior_information=100 * enough_here), Promise(0.95, pool=100, checked=100))
    assert kept is not None
    assert plenty.total_energy == 0
    assert kept.kept == kept.checked


def test_a_cap_that_the_promise_would_break_is_named() -> None:
    problem = stated(gain(2.0, 0.2, 0.3), ResponseDeviation(((0.5,),), 0.5, 1.0, 0.02, count=2))
    needed = design(problem).total_energy
    found, _ = promised(replace(problem, caps=np.array([1.05 * needed])), Promise(0.95, pool=100, checked=100))
    assert found.outcome.status == "infeasible"


def test_the_interval_is_that_of_clopper_and_pearson() -> None:
    for kept, trials in ((0, 20), (7, 20), (20, 20), (1912, 2000)):
        interval = stats.binomtest(kept, trials).proportion_ci(0.95, "exact")
        assert clopper_pearson(kept, trials, 0.95) == pytest.approx((interval.low, interval.high))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"model": gain(2.0, 0.0, 0.3)}, "no covariance"),
        ({"family": Multisines(64, (1.0,))}, "FIR or line spectra"),
        ({"box": True}, "FIR or line spectra"),
    ],
)
def test_promises_that_cannot_be_made(change: dict[str, object], words: str) -> None:
    problem = stated(gain(2.0, 0.2, 0.3), ParameterDeviation((0.1,)))
    with pytest.raises(MisuseError, match=words):
        promised(replace(problem, **change), Promise())  # type: ignore[arg-type]


def test_models_of_which_most_are_unstable_promise_nothing() -> None:
    model = replace(paper_model(), covariance=np.diag([4.0, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6]))
    problem = DesignProblem(model, np.array([[0.0], [8.0]]), (ParameterDeviation(DEVIATIONS),), FirSpectra(2), 1000)
    with pytest.raises(MisuseError, match="unstable"):
        promised(problem, Promise())
    with pytest.raises(RangeError, match="probability"):
        Promise(1.0)
