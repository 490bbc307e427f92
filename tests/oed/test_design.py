"""The certified solver: the figures of the paper, agreement with the inequality as written, and its certificate."""

from dataclasses import replace

import numpy as np
import pytest

from identification.errors import MisuseError, RangeError, ShapeError
from oed.design import Design, design
from oed.direct_lmi import direct_design
from oed.information import noise_information, sensitivity
from oed.problem import DesignProblem
from oed.spectra.fir import FirSpectra, FirSpectrum
from oed.spectra.lines import LineSpectra, LineSpectrum
from oed.targets.local_covariance import LocalCovariance
from oed.targets.parameter_deviation import ParameterDeviation
from oed.targets.response_deviation import ResponseDeviation
from tests.support.random_models import paper_model, random_model

GRID = np.arange(0.0, 8.25, 0.5)[:, None]
PAPER_TARGET = ParameterDeviation((0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3))
PAPER = DesignProblem(paper_model(), GRID, (PAPER_TARGET,), FirSpectra(10), 1000)


def energies(result: Design) -> dict[float, float]:
    return {experiment.operating_point[0]: experiment.energy for experiment in result.experiments}


def test_the_papers_example() -> None:
    result = design(PAPER)
    assert result.outcome.ok
    assert result.gap <= 1e-4
    assert result.total_energy == pytest.approx(3510.4, rel=1e-3)
    assert energies(result) == pytest.approx({0.0: 1019, 1.5: 1349, 8.0: 1143}, rel=0.01)
    assert result.samples == 1000
    assert 100 < result.required_samples < 1000


@pytest.mark.parametrize(
    ("points", "energy"), [((0, 5.5), 7903), ((0, 8), 18387), ((1.5, 8), 32763), ((0, 1.5), 57447)]
)
def test_table_1_of_the_paper(points: tuple[float, float], energy: float) -> None:
    result = design(replace(PAPER, points=np.array(points)[:, None]))
    assert result.gap <= 1e-4
    assert result.total_energy == pytest.approx(energy, rel=1e-3)


def test_energy_caps_of_the_paper() -> None:
    result = design(replace(PAPER, caps=np.full(17, 1000.0)))
    assert result.total_energy == pytest.approx(3542.6, rel=1e-3)
    assert energies(result) == pytest.approx({0: 1000, 1.5: 1000, 2: 334, 7.5: 209, 8: 1000}, rel=0.01)
    assert {binding.index for binding in result.binding if binding.what == "cap"} == {0, 3, 16}


def test_excluded_points_of_the_paper() -> None:
    result = design(replace(PAPER, points=GRID[GRID[:, 0] < 5]))
    assert result.total_energy == pytest.approx(7356.7, rel=1e-3)
    assert list(energies(result)) == [0.0, 1.0, 4.5]


@pytest.mark.parametrize(("degree", "energy"), [(20, 3281.5), (40, 3015.6), (100, 2899.9)])
def test_a_higher_degree_takes_less_energy(degree: int, energy: float) -> None:
    result = design(replace(PAPER, family=FirSpectra(degree)))
    assert result.gap <= 1e-4
    assert result.total_energy == pytest.approx(energy, rel=1e-3)


def test_line_spectra_take_least() -> None:
    result = design(replace(PAPER, family=LineSpectra(1000, constant=True)))
    assert result.gap <= 1e-4
    assert result.total_energy <= 2855.5
    spectrum = result.experiments[1].spectrum
    assert isinstance(spectrum, LineSpectrum)
    assert result.experiments[1].operating_point == (1.5,)
    assert spectrum.indices.tolist() == [0]


def test_operating_points_free_in_the_range() -> None:
    result = design(replace(PAPER, family=LineSpectra(1000, constant=True), points=GRID[::4], box=True))
    assert result.gap <= 1e-4
    assert result.total_energy == pytest.approx(2854.6, rel=1e-4)
    assert len(result.experiments) == 3
    assert result.experiments[1].operating_point[0] == pytest.approx(1.475, abs=0.01)


def random_problem(seed: int) -> DesignProblem:
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    targets = [
        ParameterDeviation.example(model),
        replace(ParameterDeviation.example(model), jointly=False),
        LocalCovariance.example(model),
        replace(ResponseDeviation.example(model), maximum_rad_per_second=2.5, count=3),
    ]
    chosen = rng.choice(4, size=rng.integers(1, 3), replace=False)
    points = np.linspace(-1, 3, int(rng.integers(4, 7)))[:, None]
    family = FirSpectra(int(rng.integers(2, 7)))
    problem = DesignProblem(model, points, (targets[0], *(targets[i] for i in chosen)), family, 1000)
    if rng.random() < 0.5:
        highest = max(energies(design(problem)).values())
        problem = replace(problem, caps=np.full(len(points), highest * rng.uniform(0.9, 1.1)))
    if rng.random() < 0.3:
        k = model.dependence.size
        problem = replace(problem, prior_information=0.3 * np.diag(np.diagonal(targets[0].matrices(model)[0])[:k]))
    return problem


@pytest.mark.parametrize("seed", range(24))
def test_agrees_with_the_inequality_as_written(seed: int) -> None:
    problem = random_problem(seed)
    direct, certified = direct_design(problem), design(problem)
    assert np.isfinite(certified.total_energy) == np.isfinite(direct.total_energy)
    if np.isfinite(direct.total_energy):
        assert 0 <= certified.gap <= 1e-4
        assert certified.total_energy == pytest.approx(direct.total_energy, rel=1e-3)
        assert certified.lower_bound <= direct.total_energy * (1 + 1e-4)
        assert sum(energies(certified).values()) == pytest.approx(certified.total_energy, rel=1e-9)


@pytest.mark.parametrize(("seed", "degree"), [(273, 6), (205, 25), (293, 25)])
def test_does_not_creep(seed: int, degree: int) -> None:
    """Problems in which forgetting directions at every step made the gap fall by a tenth a step and less."""
    result = design(replace(random_problem(seed), family=FirSpectra(degree)))
    assert result.outcome.ok
    assert result.outcome.iterations < 20


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("family", [FirSpectra(5), LineSpectra(200)])
def test_the_designed_spectra_meet_the_targets(seed: int, family: FirSpectra | LineSpectra) -> None:
    """Information summed anew over the lines of a long record, by nothing of the solver but the sensitivity."""
    problem = replace(random_problem(100 + seed), family=family, caps=None)
    result = design(problem)
    k, step = problem.model.plant_size, problem.step
    information = problem.prior.copy()
    for experiment in result.experiments:
        samples = 4000 if isinstance(family, FirSpectra) else 200
        indices, line_energies = experiment.spectrum.line_energies(samples, step)
        assert line_energies.sum() == pytest.approx(experiment.energy)
        a = sensitivity(problem.model, [experiment.operating_point], 2 * np.pi * indices / (samples * step))[0]
        information[:k, :k] += ((a.T * line_energies) @ a.conj()).real
        information[k:, k:] += result.samples * noise_information(problem.model, [experiment.operating_point])[0]
    for target in problem.targets:
        for matrix in target.matrices(problem.model):
            scale = np.sqrt(np.diagonal(information))
            assert np.linalg.eigvalsh((information - matrix) / np.outer(scale, scale))[0] >= -1e-6
    scale = np.sqrt(np.diagonal(information))
    product = (result.expected_covariance * np.outer(scale, scale)) @ (information / np.outer(scale, scale))
    assert product == pytest.approx(np.eye(len(product)), abs=1e-4)


def test_energy_scales_with_accuracy_and_noise() -> None:
    model = paper_model()
    plain = design(PAPER).total_energy
    tighter = ParameterDeviation(tuple(s / 2 for s in PAPER_TARGET.standard_deviations if s))
    assert design(replace(PAPER, targets=(tighter,))).total_energy == pytest.approx(4 * plain, rel=1e-3)
    noisier = replace(model, noise_variance=1.5)
    assert design(replace(PAPER, model=noisier)).total_energy == pytest.approx(3 * plain, rel=1e-3)


def test_single_standard_deviations_take_less_than_the_ellipsoid() -> None:
    alone = design(replace(PAPER, targets=(replace(PAPER_TARGET, jointly=False),)))
    assert alone.gap <= 1e-4
    assert alone.total_energy < 0.95 * design(PAPER).total_energy
    deviations = np.sqrt(np.diagonal(alone.expected_covariance))[:4]
    assert np.all(deviations <= np.array(PAPER_TARGET.standard_deviations[:4], dtype=float) * (1 + 1e-6))


def test_prior_information_lessens_the_energy() -> None:
    wanted = PAPER_TARGET.matrices(paper_model())[0]
    half = design(replace(PAPER, prior_information=wanted / 2))
    assert half.total_energy == pytest.approx(3510.4 / 2, rel=1e-3)
    everything = design(replace(PAPER, prior_information=2 * wanted))
    assert everything.outcome.ok
    assert everything.total_energy == 0
    assert everything.experiments == ()


def test_duration_follows_rule_18() -> None:
    result = design(replace(PAPER, points=np.array([[0.0], [1.5]]), samples=1000))
    assert result.required_samples > 1000
    assert result.samples == int(result.required_samples) + 1
    per_sample = noise_information(paper_model(), [[0.0], [1.5]]).sum(axis=0)
    wanted = np.diag([(0.35 / 3) ** -2, (0.04 / 3) ** -2])
    assert np.linalg.eigvalsh(result.required_samples * per_sample - wanted)[0] == pytest.approx(0, abs=1e-6)


def test_a_continuous_time_plant_needs_the_sample_time_of_the_input() -> None:
    model = paper_model()
    structure = replace(model.structure, n_k=0, n_d=0, n_a=1, n_b=0, sample_time=None)
    bases = model.dependence.bases[:2]
    theta = np.array([0.5, 0.1, 2.0, 0.1])
    continuous = replace(
        model, structure=structure, dependence=replace(model.dependence, bases=bases), theta=theta, covariance=np.eye(4)
    )
    target = ParameterDeviation((0.01, 0.01, 0.01, 0.01))
    with pytest.raises(MisuseError, match="sample time"):
        DesignProblem(continuous, GRID, (target,), LineSpectra(512), 512)
    lines = design(DesignProblem(continuous, GRID, (target,), LineSpectra(512), 512, sample_time=0.1))
    smooth = design(DesignProblem(continuous, GRID, (target,), FirSpectra(30), 512, sample_time=0.1))
    assert lines.outcome.ok
    assert smooth.outcome.ok
    assert lines.total_energy < smooth.total_energy


def test_a_band_limits_the_lines() -> None:
    result = design(replace(PAPER, family=LineSpectra(1000), band=(0.5, 2.0)))
    assert result.outcome.ok
    assert result.total_energy > 2855.5
    for experiment in result.experiments:
        assert isinstance(experiment.spectrum, LineSpectrum)
        assert np.all((experiment.spectrum.frequencies >= 0.5 - 1e-9) & (experiment.spectrum.frequencies <= 2 + 1e-9))


def test_what_cannot_be_reached_says_why() -> None:
    capped = design(replace(PAPER, caps=np.full(17, 200.0)))
    assert capped.outcome.status == "infeasible"
    assert "48.4 %" in capped.outcome.advice
    assert "factor 1.44" in capped.outcome.advice
    looser = ParameterDeviation(tuple(1.45 * s for s in PAPER_TARGET.standard_deviations if s))
    assert design(replace(PAPER, targets=(looser,), caps=np.full(17, 200.0))).outcome.ok
    alone = design(replace(PAPER, points=np.array([[3.0]])))
    assert alone.outcome.status == "infeasible"
    assert "at least 2 distinct operating points" in alone.outcome.advice
    assert np.isinf(alone.total_energy)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"points": np.array([[9.0]])}, RangeError, "outside its range"),
        ({"points": np.array([[1.0], [1.0]])}, ShapeError, "each of them once"),
        ({"points": np.array([1.0, 2.0])}, ShapeError, "rows"),
        ({"targets": ()}, MisuseError, "no accuracy target"),
        ({"samples": 0}, RangeError, "positive"),
        ({"caps": np.ones(3)}, ShapeError, "17 points"),
        ({"caps": np.zeros(17)}, RangeError, "not positive"),
        ({"prior_information": np.eye(4)}, ShapeError, "must be"),
        ({"prior_information": -np.eye(6)}, RangeError, "semidefinite"),
        ({"band": (2.0, 4.0)}, RangeError, "must rise"),
        ({"tolerance": 0.0}, RangeError, "tolerance"),
    ],
)
def test_requests_that_make_no_sense(change: dict[str, object], error: type[MisuseError], words: str) -> None:
    with pytest.raises(error, match=words):
        replace(PAPER, **change)


def test_unstable_models_and_unfit_families_are_refused() -> None:
    with pytest.raises(MisuseError, match="unstable at the operating point"):
        design(replace(PAPER, model=paper_model((-1.1, 0.1, 10.0, -1.0, -0.7, 0.08))))
    with pytest.raises(RangeError, match="no band limits"):
        design(replace(PAPER, band=(0.1, 1.0)))
    with pytest.raises(ShapeError, match="6 parameters"):
        design(replace(PAPER, targets=(ParameterDeviation((0.1,)),)))


def test_the_same_request_gives_the_same_answer() -> None:
    first, second = design(PAPER), design(PAPER)
    assert first.total_energy == second.total_energy
    for one, other in zip(first.experiments, second.experiments, strict=True):
        assert isinstance(one.spectrum, FirSpectrum)
        assert isinstance(other.spectrum, FirSpectrum)
        assert np.array_equal(one.spectrum.coefficients, other.spectrum.coefficients)
