"""Figures of designs that can be had by hand: near-singular knowledge, directions that stay unknown, whole periods."""

from dataclasses import replace

import numpy as np
import pytest

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import RangeError
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from oed.design import design
from oed.pencil import Pencil, covariance_of, shares
from oed.problem import DesignProblem
from oed.spectra.fir import FirSpectra
from oed.spectra.lines import LineSpectra, LineSpectrum
from oed.targets.parameter_deviation import ParameterDeviation
from tests.support.random_models import paper_model


def gain(degree: int, lowest: float, highest: float, noise_variance: float) -> Model:
    """y = (b0 + b1 p + …) u + e."""
    structure = RationalStructure(n_a=0, n_b=0, n_k=0, n_c=0, n_d=0, sample_time=1.0)
    variable = SchedulingVariable("p", "1", lowest, highest)
    dependence = ParameterDependence((variable,), (ProductBasis((Polynomial(degree),)),))
    return Model(structure, dependence, np.ones(degree + 1), np.zeros((degree + 1,) * 2), noise_variance)


def known_at(model: Model, points: list[float], energy: float) -> FloatArray:
    rows = model.dependence.matrix(np.array(points)[:, None])[:, 0]
    return np.asarray(energy / model.noise_variance * rows.T @ rows)


@pytest.mark.parametrize("family", [FirSpectra(2), LineSpectra(64)])
@pytest.mark.parametrize(("energy", "deviation"), [(1e2, 1e-4), (1e5, 1e-4), (1e8, 1e-4), (1e2, 1e-2)])
def test_curvature_of_a_prior_at_two_points(energy: float, deviation: float, family: FirSpectra | LineSpectra) -> None:
    """b2 = (g1 − 2 g2 + g3)/5000 with variances σ²/E: 1/E3 = (5000 δ)²/σ² − 5/E, which must not read "none needed"."""
    model = gain(2, 1000.0, 1100.0, 0.25)
    problem = DesignProblem(
        model,
        np.array([[1000.0], [1050.0], [1100.0]]),
        (ParameterDeviation((None, None, deviation)),),
        family,
        64,
        prior_information=known_at(model, [1000.0, 1050.0], energy),
    )
    found = design(problem)
    by_hand = 1 / ((5000 * deviation) ** 2 / 0.25 - 5 / energy)
    assert found.outcome.ok
    assert found.total_energy == pytest.approx(by_hand, rel=2e-4)
    assert [one.operating_point for one in found.experiments] == [(1100.0,)]
    assert np.sqrt(found.expected_covariance[2, 2]) == pytest.approx(deviation, rel=1e-4)


def test_one_direction_that_stays_unknown_does_not_void_the_others() -> None:
    model = gain(1, 0.0, 1.0, 0.25)
    problem = DesignProblem(model, np.array([[0.0]]), (ParameterDeviation((0.1, None)),), FirSpectra(2), 64)
    found = design(problem)
    assert found.outcome.ok
    assert found.total_energy == pytest.approx(25)
    assert found.expected_covariance[0, 0] == pytest.approx(0.01)
    assert np.isinf(found.expected_covariance[1, 1])
    both = design(replace(problem, targets=(ParameterDeviation((0.1, 0.1)),)))
    assert both.outcome.status == "infeasible"
    with_slope = design(replace(problem, points=np.array([[0.5]]), targets=(ParameterDeviation((0.1, None)),)))
    assert with_slope.outcome.status == "infeasible"
    known = design(replace(problem, points=np.array([[0.5]]), prior_information=np.diag([0.0, 1e4])))
    assert known.total_energy == pytest.approx(0.25 / (0.1**2 - 0.25 * 1e-4), rel=1e-3)


def test_a_target_is_never_called_met_while_what_it_asks_for_is_unknown() -> None:
    model = gain(1, 0.0, 1.0, 0.25)
    asked = ParameterDeviation((1e-3, 1e6))
    prior = np.diag([4e6, 0.0])
    problem = DesignProblem(model, np.array([[0.0], [1.0]]), (asked,), LineSpectra(64), 64, prior_information=prior)
    found = design(problem)
    assert found.total_energy > 0
    assert found.expected_covariance[1, 1] <= 1e12 * (1 + 1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_shares_do_not_depend_on_units(seed: int) -> None:
    rng = np.random.default_rng(seed)
    factor, asked = rng.normal(size=(5, 3)), rng.normal(size=(5, 2))
    information, target = factor @ factor.T, (factor @ asked[:3]) @ (factor @ asked[:3]).T
    units = np.diag(10.0 ** rng.uniform(-6, 6, 5))
    ratio = shares(units @ information @ units, np.zeros((5, 5)), (units @ target @ units)[None])[0]
    assert ratio == pytest.approx(np.linalg.eigvalsh(asked[:3] @ asked[:3].T)[-1], rel=1e-6)
    outside = target + 1e-6 * np.outer(asked[:, 0], asked[:, 0])
    assert np.isinf(shares(units @ information @ units, np.zeros((5, 5)), (units @ outside @ units)[None])[0])


def test_what_both_tell_is_resolved_where_one_tells_far_more() -> None:
    strong, weak = np.array([[1.0, 1.0], [1.0, 1.0]]) * 1e14, np.array([[1.0, -1.0], [-1.0, 1.0]])
    pencil = Pencil.of(strong, weak)
    assert np.sort(pencil.prior / pencil.gain)[0] <= 1e-12
    assert covariance_of(strong, weak) == pytest.approx(np.full((2, 2), 0.25) * [[1, -1], [-1, 1]], rel=1e-6)
    target = np.array([[1.0, -1.0], [-1.0, 1.0]])[None] * 7
    assert pencil.least(target) == pytest.approx(7, rel=1e-6)


def test_the_factor_to_relax_by_is_never_one() -> None:
    target = ParameterDeviation((0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3))
    problem = DesignProblem(paper_model(), np.arange(0.0, 8.5, 0.5)[:, None], (target,), FirSpectra(10), 1000)
    largest = max(one.energy for one in design(problem).experiments)
    advice = ""
    for cap in largest * np.linspace(0.30, 0.35, 11):
        found = design(replace(problem, caps=np.full(17, cap)))
        advice = found.outcome.advice if not found.outcome.ok else advice
    factor = float(advice.split("by a factor ")[1].split(",")[0])
    assert 1 < factor < 1.2
    found = design(replace(problem, caps=np.full(17, 0.30 * largest)))
    factor = float(found.outcome.advice.split("by a factor ")[1].split(",")[0])
    looser = ParameterDeviation(tuple(factor * one for one in target.standard_deviations if one))
    assert design(replace(problem, caps=np.full(17, 0.30 * largest), targets=(looser,))).outcome.ok


def test_a_gap_is_never_negative_and_no_line_is_a_constant_unless_asked_for() -> None:
    model = paper_model()
    points = np.arange(0.0, 8.5, 0.5)[:, None]
    target = ParameterDeviation((0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, None, None))
    for tolerance in (1e-3, 1e-5, 1e-7):
        found = design(DesignProblem(model, points, (target,), LineSpectra(400), 400, tolerance=tolerance))
        assert 0 <= found.gap <= tolerance
        for one in found.experiments:
            assert isinstance(one.spectrum, LineSpectrum)
            assert one.spectrum.indices.min() >= 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"model": paper_model(noise_variance=0.0)}, "without noise"),
        ({"prior_information": np.triu(np.ones((6, 6))) + 5 * np.eye(6)}, "not symmetric"),
        ({"prior_information": np.diag([1.0, 1, 1, 1, 1, -1e-3])}, "semidefinite"),
    ],
)
def test_what_is_known_must_make_sense(change: dict[str, object], words: str) -> None:
    target = ParameterDeviation((0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3))
    problem = DesignProblem(paper_model(), np.array([[0.0], [8.0]]), (target,), FirSpectra(4), 1000)
    with pytest.raises(RangeError, match=words):
        replace(problem, **change)  # type: ignore[arg-type]
