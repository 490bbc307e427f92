"""Candidate multisines: the programme against cvxpy, whole periods, and what makes no sense."""

from dataclasses import replace

import cvxpy
import numpy as np
import pytest

from identification.arrays import FloatArray
from identification.effects.quadratic_stiffness import QuadraticStiffness
from identification.errors import MisuseError, RangeError
from identification.places.placed import placed
from oed.design import Design, design
from oed.information import noise_information
from oed.problem import DesignProblem
from oed.spectra.multisines import MultisinePricing, Multisines, MultisineSpectrum
from oed.statement import stated
from oed.targets.effect_detection import EffectDetection
from oed.targets.parameter_deviation import ParameterDeviation
from tests.support.oscillators import MODEL, SAMPLE_TIME
from tests.support.random_models import paper_model

PLANT = replace(MODEL, noise_variance=1e-4)
POINTS = np.linspace(-1, 1, 3)[:, None]
FAMILY = Multisines(128, (1.0, 2.0, 6.0), ((0.4, 6.0), (4.0, 12.0), (0.4, 30.0)), seed=3)
SEEN = EffectDetection("cubic_stiffness", 0.05)
THETA = ParameterDeviation((0.02, 0.3, 0.3, 0.01))


def problem(*targets: object, **options: object) -> DesignProblem:
    given = {"model": PLANT, "points": POINTS, "family": FAMILY, "samples": 128_000, "sample_time": SAMPLE_TIME}
    return DesignProblem(targets=tuple(targets), **{**given, **options})  # type: ignore[arg-type]


def as_written(asked: DesignProblem) -> float:
    """min Σ E_c n_c  s.t.  Σ n_c I_c ⪰ R,  0 ≤ n_c ≤ most, over real numbers of periods n_c of every candidate."""
    statement = stated(asked)
    pricing = statement.pricing
    assert isinstance(pricing, MultisinePricing)
    k, most = statement.plant, asked.samples // 128
    scale = 1 / np.sqrt(np.diagonal(pricing.information.sum(axis=0)))
    per_period = pricing.information * pricing.energies[:, None, None] * np.outer(scale, scale)
    unit = 1e-3 / per_period.max()
    n = cvxpy.Variable(len(per_period), nonneg=True)
    total = cvxpy.reshape(unit * per_period.reshape(-1, k * k).T @ n, (k, k), order="C")
    limits = [n <= most]
    targets = [total - unit * target * np.outer(scale, scale) >> 0 for target in statement.targets[:, :k, :k]]
    least = cvxpy.Problem(cvxpy.Minimize(pricing.energies @ n), limits + targets)
    return float(least.solve(solver=cvxpy.CLARABEL))


@pytest.mark.parametrize(
    "options", [{}, {"samples": 128 * 6}, {"model": PLANT.plus(placed(QuadraticStiffness(), 0, 1, 0.3))}]
)
@pytest.mark.parametrize("targets", [(SEEN,), (THETA, SEEN)])
def test_agrees_with_the_programme_as_written(targets: tuple[object, ...], options: dict[str, object]) -> None:
    asked = problem(*targets, **options)
    result = design(asked)
    assert 0 <= result.gap <= 1e-4
    assert result.least_energy == pytest.approx(as_written(asked), rel=1e-3)
    assert result.least_energy * (1 - 1e-4) <= result.lower_bound <= result.total_energy
    assert _periods(result).max() <= asked.samples // 128


def _periods(result: Design) -> np.ndarray:
    spectra = [one.spectrum for one in result.experiments]
    assert all(isinstance(one, MultisineSpectrum) for one in spectra)
    return np.array([one.periods for one in spectra if isinstance(one, MultisineSpectrum)])


def test_whole_periods_meet_the_targets_and_none_is_idle() -> None:
    asked = problem(THETA, SEEN)
    result, statement = design(asked), stated(problem(THETA, SEEN))
    pricing = statement.pricing
    assert isinstance(pricing, MultisinePricing)
    total, spare = np.zeros((statement.plant,) * 2), []
    for one in result.experiments:
        assert isinstance(one.spectrum, MultisineSpectrum)
        place = int(np.flatnonzero(POINTS[:, 0] == one.operating_point[0])[0])
        number = [np.array_equal(one.spectrum.phasors, signal.phasors) for signal in pricing.signals].index(True)
        candidate = np.flatnonzero((pricing.places == place) & (pricing.numbers == number))[0]
        shown = one.energy * pricing.information[candidate]
        total += shown
        spare.append(shown if one.spectrum.periods == 2 else shown / one.spectrum.periods)
    scale = 1 / np.sqrt(np.diagonal(total))

    def slack(information: FloatArray) -> float:
        left = information - statement.targets[:, : statement.plant, : statement.plant]
        return float(np.linalg.eigvalsh(left * np.outer(scale, scale))[:, 0].min())

    assert slack(total) >= -1e-9
    assert all(slack(total - one) < 0 for one in spare)
    assert _periods(result).min() >= 2
    assert result.decisions[0][1].power >= 0.9
    assert sum(one.energy for one in result.experiments) == pytest.approx(result.total_energy)


def test_signals_have_the_levels_and_bands_asked_for() -> None:
    signals = Multisines(128, (2.0, 0.5), ((1.0, 5.0),), share=0.5, draws=2, seed=1).signals(None, SAMPLE_TIME)
    assert [float(one.period().std()) for one in signals] == pytest.approx([0.5, 0.5, 2.0, 2.0])
    for one in signals:
        assert 1.0 <= one.frequencies[0] <= one.frequencies[-1] <= 5.0
        assert np.sum(one.period() ** 2) == pytest.approx(one.energy)
        lines = np.fft.rfft(one.period())
        assert lines[one.indices] == pytest.approx(64 * one.phasors)
        assert np.allclose(np.delete(lines, one.indices), 0, atol=1e-9)
    narrowed = Multisines(128, (1.0,), ((1.0, 5.0),)).signals((2.0, 3.0), SAMPLE_TIME)
    assert 2.0 <= narrowed[0].frequencies[0] <= narrowed[0].frequencies[-1] <= 3.0
    assert not np.array_equal(signals[0].phasors, signals[1].phasors)
    again = Multisines(128, (2.0, 0.5), ((1.0, 5.0),), share=0.5, draws=2, seed=1).signals(None, SAMPLE_TIME)
    assert all(np.array_equal(a.phasors, b.phasors) for a, b in zip(signals, again, strict=True))


def test_caps_and_duration_leave_candidates_out() -> None:
    result = design(problem(SEEN, caps=np.full(3, 128 * 4.0 * 100)))
    assert all(one.energy <= 128 * 4.0 * 100 * (1 + 1e-9) for one in result.experiments)
    with pytest.raises(RangeError, match="not even 2 periods"):
        design(problem(SEEN, samples=200))
    short = design(problem(EffectDetection("cubic_stiffness", 1e-5), samples=256))
    assert short.outcome.status == "infeasible"
    assert "levels" in short.outcome.advice


def test_the_noise_model_is_learnt_as_long_as_is_played() -> None:
    model, points = paper_model(noise_variance=1e-4), np.array([[0.0], [4.0], [8.0]])
    family = Multisines(64, (1.0, 4.0))
    for deviation, status in ((0.3, "converged"), (1e-4, "infeasible")):
        target = ParameterDeviation((0.02, 0.01, 0.2, 0.1, deviation, deviation))
        found = design(DesignProblem(model, points, (target,), family, 64_000))
        assert found.outcome.status == status
        played = zip(found.experiments, 64 * _periods(found), strict=True)
        known = [length * noise_information(model, [one.operating_point])[0] for one, length in played]
        assert np.linalg.inv(found.expected_covariance[4:, 4:]) == pytest.approx(np.sum(known, axis=0), rel=1e-6)


def test_levels_at_which_there_is_no_steady_state_are_left_out() -> None:
    soft = PLANT.plus(placed(QuadraticStiffness(), 0, 1, 30.0))
    statement = stated(problem(THETA, model=soft))
    pricing = statement.pricing
    assert isinstance(pricing, MultisinePricing)
    levels = [round(float(pricing.signals[n].period().std())) for n in pricing.numbers]
    assert levels.count(1) == 9
    assert levels.count(6) < 9


def test_families_that_make_no_sense() -> None:
    for options, words in (
        ({"samples": 4}, "too few lines"),
        ({"levels": ()}, "at least one level"),
        ({"levels": (-1.0,)}, "positive"),
        ({"share": 0.0}, "between 0 and 1"),
        ({"draws": 0}, "from 1 to 100"),
        ({"bands": ((2.0, 1.0),)}, "must rise"),
    ):
        with pytest.raises(RangeError, match=words):
            replace(FAMILY, **options)  # type: ignore[arg-type]
    with pytest.raises(MisuseError, match="give a grid"):
        design(problem(SEEN, box=True))
    with pytest.raises(RangeError, match="too long"):
        design(problem(SEEN, family=replace(FAMILY, samples=2**22)))
    with pytest.raises(RangeError, match="candidates"):
        design(problem(SEEN, family=replace(FAMILY, levels=tuple(np.arange(1.0, 5000.0)))))
    with pytest.raises(RangeError, match="no line"):
        design(problem(SEEN, family=Multisines(128, (1.0,), ((0.01, 0.02),))))
