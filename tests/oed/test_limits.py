"""Limits of the plant: agreement with the inequality as written, what is played, contradictions and bad input."""

from dataclasses import replace
from typing import Any

import cvxpy
import numpy as np
import pytest

import oed.limits
from identification.errors import MisuseError, RangeError
from identification.registry import discover
from oed.design import Design, design
from oed.direct_lmi import direct_design
from oed.information import sensitivity
from oed.limits.forbidden_band import ForbiddenBand
from oed.limits.input_power import InputPower
from oed.limits.output_power import OutputPower
from oed.problem import DesignProblem
from oed.spectra.fir import FirSpectra
from oed.spectra.lines import LineSpectra
from oed.spectra.multisines import Multisines
from oed.targets.parameter_deviation import ParameterDeviation
from oed.targets.response_deviation import ResponseDeviation
from tests.support.random_models import paper_model, random_model

LINES = 24
POINTS = np.linspace(-1, 1, 5)[:, None]


def stated(seed: int, family: Any = None) -> DesignProblem:
    """A random problem without limits."""
    model = random_model(np.random.default_rng(seed))
    target = ParameterDeviation((*(0.05,) * model.plant_size, *(None,) * model.noise_size))
    return DesignProblem(model, POINTS, (target,), family or LineSpectra(2 * LINES), 1000)


def grid(problem: DesignProblem) -> np.ndarray:
    """All lines, rad/s."""
    return np.asarray(2 * np.pi * np.arange(1, LINES + 1) / (2 * LINES * problem.step))


def gains(problem: DesignProblem, omega: np.ndarray) -> np.ndarray:
    """|G|² (M, F)."""
    return np.asarray(abs(problem.model.frequency_response(problem.points, omega)[..., 0, 0]) ** 2)


def output_rms(problem: DesignProblem, found: Design, point: int) -> float:
    """Of the output at a point, summed over the lines of a long period."""
    here = [one for one in found.experiments if np.allclose(one.operating_point, problem.points[point])]
    if not here:
        return 0.0
    spectrum = here[0].spectrum
    period = spectrum.samples if hasattr(spectrum, "samples") else 4096
    indices, energies = spectrum.line_energies(period, problem.step)
    omega = 2 * np.pi * indices / (period * problem.step)
    return float(np.sqrt(gains(problem, omega)[point] @ energies / problem.samples))


def as_written(problem: DesignProblem, rows: np.ndarray, most: np.ndarray) -> float:
    """Least energy over energies of every line, with Σ rows E ≤ most (M,) at every point; by a conic solver alone."""
    omega = grid(problem)
    a = sensitivity(problem.model, problem.points, omega)
    k = problem.model.plant_size
    asked = problem.targets[0].matrices(problem.model)[0, :k, :k]
    each = np.einsum("mfi,mfj->mfij", a, a.conj()).real
    scale = np.linalg.inv(np.linalg.cholesky(each.mean(axis=(0, 1)))).T
    each, asked = scale.T @ each @ scale, scale.T @ asked @ scale
    unit = float(np.linalg.eigvalsh(asked)[-1])
    energies = cvxpy.Variable((len(POINTS), LINES), nonneg=True)
    total = cvxpy.reshape(each.reshape(-1, k * k).T @ cvxpy.vec(energies, order="C"), (k, k), order="C")
    limits = [
        rows[m] @ energies[m] <= most[m] / unit for m in range(len(POINTS)) if np.isfinite(most[m]) and rows[m].any()
    ]
    task = cvxpy.Problem(cvxpy.Minimize(cvxpy.sum(energies)), [total >> asked / unit, *limits])
    task.solve(solver=cvxpy.CLARABEL)
    return float(task.value) * unit if task.status == cvxpy.OPTIMAL else np.inf


@pytest.mark.parametrize("seed", range(6))
def test_output_power_agrees_with_the_inequality_as_written(seed: int) -> None:
    free = stated(seed)
    unlimited = design(free)
    strongest = max(range(5), key=lambda m: output_rms(free, unlimited, m))
    rows = gains(free, grid(free))
    for share in (0.6, 0.8, 0.95, 0.99):
        rms = share * output_rms(free, unlimited, strongest)
        found = design(replace(free, plant_limits=(OutputPower(rms),)))
        expected = as_written(free, rows, np.full(5, rms**2 * free.samples))
        assert found.outcome.status == ("converged" if np.isfinite(expected) else "infeasible")
        if found.outcome.ok:
            break
    assert found.outcome.ok
    assert found.gap <= 1e-4
    assert found.total_energy == pytest.approx(expected, rel=1e-3)
    assert found.total_energy > 1.0001 * unlimited.total_energy
    assert max(output_rms(free, found, m) for m in range(5)) <= rms * (1 + 1e-6)
    binding = [one for one in found.binding if one.what == "limit"]
    assert strongest in {one.point for one in binding}


def test_a_limit_that_does_not_bind_changes_nothing_however_many_targets_there_are() -> None:
    target = ResponseDeviation(tuple((float(p),) for p in range(0, 9, 2)), 0.06, 0.6, 0.01)
    free = DesignProblem(paper_model(), np.linspace(0, 8, 17)[:, None], (target,), LineSpectra(500), 1000)
    unlimited = design(free)
    highest = max(output_rms(free, unlimited, m) for m in range(17))
    loose = design(replace(free, plant_limits=(OutputPower(1.2 * highest),)))
    assert loose.outcome.ok
    assert loose.total_energy == pytest.approx(unlimited.total_energy, rel=3e-4)
    assert {one.what for one in loose.binding} == {"target"}
    tight = design(replace(free, plant_limits=(OutputPower(0.7 * highest),)))
    assert tight.outcome.ok
    assert tight.gap <= 1e-4
    assert tight.total_energy > loose.total_energy


def test_the_multiplier_of_a_limit_is_what_more_of_it_would_save() -> None:
    free = stated(1)
    rms = 0.6 * max(output_rms(free, design(free), m) for m in range(5))
    fine = replace(free, tolerance=1e-6)
    energies = [
        design(replace(fine, plant_limits=(OutputPower(rms * factor**0.5),))).total_energy for factor in (0.99, 1.01)
    ]
    found = design(replace(fine, plant_limits=(OutputPower(rms),)))
    saved = -(np.log(energies[1]) - np.log(energies[0])) / (np.log(1.01) - np.log(0.99))
    assert sum(one.multiplier for one in found.binding if one.what == "limit") == pytest.approx(saved, rel=0.03)


@pytest.mark.parametrize("seed", range(3))
def test_fir_spectra_under_limits_agree_with_the_inequality_as_written(seed: int) -> None:
    free = stated(seed, FirSpectra(6))
    unlimited = design(free)
    rms = 0.8 * max(output_rms(free, unlimited, m) for m in range(5))
    limits = (OutputPower(rms), InputPower(10 * rms, maximum_rad_per_second=1.0 / free.step))
    limited = replace(free, plant_limits=limits)
    found = design(limited)
    assert found.outcome.ok
    assert found.total_energy == pytest.approx(direct_design(limited).total_energy, rel=1e-3)
    assert max(output_rms(free, found, m) for m in range(5)) <= rms * (1 + 1e-4)


def test_a_limit_at_one_point_and_in_one_band_leaves_the_others_free() -> None:
    free = stated(2)
    unlimited = design(free)
    point = max(range(5), key=lambda m: output_rms(free, unlimited, m))
    where = (tuple(free.points[point].tolist()),)
    rms = 0.5 * output_rms(free, unlimited, point)
    limited = design(replace(free, plant_limits=(OutputPower(rms, operating_points=where),)))
    assert output_rms(free, limited, point) <= rms * (1 + 1e-6)
    assert {one.point for one in limited.binding if one.what == "limit"} == {point}
    omega = grid(free)
    band = (float(omega[0] * 0.9), float(omega[3] * 1.1))
    in_band = design(replace(free, plant_limits=(OutputPower(rms, *band),)))
    rows = np.where((omega >= band[0]) & (omega <= band[1]), gains(free, omega), 0.0)
    assert in_band.total_energy == pytest.approx(as_written(free, rows, np.full(5, rms**2 * free.samples)), rel=1e-3)


def test_nothing_is_excited_in_a_forbidden_band() -> None:
    free = stated(3)
    used = design(free).experiments[0]
    line = float(used.spectrum.frequencies[0])
    found = design(replace(free, plant_limits=(ForbiddenBand(0.9 * line, 1.1 * line),)))
    assert found.outcome.ok
    for one in found.experiments:
        assert not np.any(abs(one.spectrum.frequencies / line - 1) <= 0.1)
    elsewhere = ForbiddenBand(0.9 * line, 1.1 * line, (used.operating_point,))
    partly = design(replace(free, plant_limits=(elsewhere,)))
    assert design(free).total_energy < partly.total_energy * (1 + 1e-4) <= found.total_energy * (1 + 3e-4)


def test_limits_that_contradict_the_targets_are_named_with_how_much_is_missing() -> None:
    free = stated(1)
    rms = 0.02 * max(output_rms(free, design(free), m) for m in range(5))
    limited = replace(free, plant_limits=(OutputPower(rms),))
    refused = design(limited)
    assert refused.outcome.status == "infeasible"
    assert "output's root mean square" in refused.outcome.advice
    factor = float(refused.outcome.advice.split("power × ")[1].split(",")[0])
    just = replace(free, plant_limits=(OutputPower(rms * np.sqrt(1.01 * factor)),))
    hardly = replace(free, plant_limits=(OutputPower(rms * np.sqrt(0.98 * factor)),))
    assert design(just).outcome.ok
    assert design(hardly).outcome.status == "infeasible"


def test_candidate_multisines_keep_the_limits_at_their_levels() -> None:
    model = paper_model()
    target = ParameterDeviation((0.03, 0.01, 0.3, 0.03, 3.5, 0.4), jointly=False)
    family = Multisines(samples=64, levels=(0.1, 1.0, 10.0))
    free = DesignProblem(model, np.array([[0.0], [4.0], [8.0]]), (target,), family, 64 * 200)
    found = design(replace(free, plant_limits=(InputPower(2.0),)))
    assert found.experiments
    assert all(one.spectrum.level <= 2.0 for one in found.experiments)
    with pytest.raises(RangeError, match="no candidate keeps"):
        design(replace(free, plant_limits=(InputPower(0.01),)))


def test_bad_limits_are_refused() -> None:
    free = stated(0)
    with pytest.raises(RangeError, match="positive"):
        OutputPower(0.0)
    with pytest.raises(RangeError, match="rise"):
        InputPower(1.0, 2.0, 1.0)
    with pytest.raises(RangeError, match="none of the operating points"):
        design(replace(free, plant_limits=(OutputPower(1.0, operating_points=((0.123,),)),)))
    with pytest.raises(RangeError, match="FIR spectrum cannot"):
        design(replace(stated(0, FirSpectra(4)), plant_limits=(ForbiddenBand(0.1, 0.2),)))
    with pytest.raises(RangeError, match="leave no line"):
        design(replace(free, plant_limits=(ForbiddenBand(0.0, 4.0 / free.step),)))
    with pytest.raises(MisuseError, match="grid"):
        replace(free, box=True, plant_limits=(OutputPower(1.0),))


@pytest.mark.parametrize("kind", sorted(discover(oed.limits)))
def test_every_limit_of_the_registry_weighs_what_it_says(kind: str) -> None:
    model = random_model(np.random.default_rng(0))
    limit = discover(oed.limits)[kind].example(model)
    omega = np.linspace(0.0, np.pi, 50)
    weights, most = limit.weights(model, POINTS, omega), limit.most(model, POINTS)
    assert weights.shape == (5, 50)
    assert np.all(weights >= 0)
    assert np.all(most >= 0)
    assert limit.words
