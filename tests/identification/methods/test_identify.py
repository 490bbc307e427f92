"""The one verb: right within its own deviations for every kind of data and structure, and clear about what is wrong."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import identification
import identification.methods
from identification import (
    FrequencyResponse,
    MisuseError,
    Polynomial,
    ProductBasis,
    RationalStructure,
    SchedulingVariable,
    StateSpaceStructure,
    TimeRecord,
    TwoStep,
    VaryingRecord,
    identify,
)
from identification.methods.method import Method
from identification.registry import discover
from tests.support.varying import cox_plant, turbine, white

SPEED = (SchedulingVariable("speed", "1", 0.0, 1.0),)
AFFINE = ProductBasis((Polynomial(1),))
FIRST = RationalStructure(1, 0, n_k=1, sample_time=1.0)
SECOND = RationalStructure(2, 0)
OMEGA = np.geomspace(0.3, 12, 40)
ONE_STATE = StateSpaceStructure(1)


def record(p: float, seed: int, point: tuple[float, ...]) -> TimeRecord:
    """y(t) = (0.7 + 0.2 p) y(t−1) + 0.5 u(t−1) + e(t), made by a filter that knows nothing of models."""
    g = np.random.default_rng(seed)
    u, e = g.standard_normal(800), 0.1 * g.standard_normal(800)
    a = [1, -(0.7 + 0.2 * p)]
    return TimeRecord(u, lfilter([0, 0.5], a, u) + e, 1.0, point)


def response(p: float, seed: int) -> FrequencyResponse:
    """1/((jω)² + 0.8 jω + 4 + 3p) with a relative error of one per cent."""
    g = np.random.default_rng(seed)
    exact = 1 / (4 + 3 * p - OMEGA**2 + 0.8j * OMEGA)
    noise = 0.01 * abs(exact) * (g.standard_normal((2, len(OMEGA))).T @ [1, 1j]) / np.sqrt(2)
    return FrequencyResponse(OMEGA, exact + noise, (p,), variance=(0.01 * abs(exact)) ** 2)


def off(estimate: identification.Estimate, truth: list[float]) -> float:
    """(θ̂ − θ)ᵀ P⁻¹ (θ̂ − θ), one for each parameter on average."""
    error = estimate.model.theta - truth
    return float(error @ np.linalg.solve(estimate.model.covariance, error))


def test_three_lines_from_arrays_to_a_model_with_covariance() -> None:
    distances = [off(identify(record(0.5, seed, ()), FIRST), [-0.8, 0.5]) for seed in range(20)]
    assert 1.0 < np.mean(distances) < 3.4
    one = identify(record(0.5, 0, ()), FIRST).model
    exact = 0.5 / (np.exp(1j * OMEGA) - 0.8)
    assert np.allclose(one.frequency_response(np.zeros((1, 0)), OMEGA)[0, :, 0, 0], exact, rtol=0.1)


def test_records_over_the_scheduling_variable() -> None:
    how = FIRST.over(SPEED, AFFINE, b0=ProductBasis((Polynomial(0),)))
    found = identify([record(p, i, (p,)) for i, p in enumerate((0.0, 0.5, 1.0))], FIRST, how)
    assert found.outcome.ok
    assert len(found.local) == 3
    assert off(found, [-0.7, -0.2, 0.5]) < 16
    assert np.sqrt(found.model.noise_variance) == pytest.approx(0.1, rel=0.1)


def test_responses_of_a_plant_in_continuous_time() -> None:
    how = SECOND.over(SPEED, AFFINE, a1=ProductBasis((Polynomial(0),)), b0=ProductBasis((Polynomial(0),)))
    found = identify([response(p, i) for i, p in enumerate((0.0, 0.4, 1.0))], SECOND, how)
    assert found.outcome.ok
    assert off(found, [0.8, 4.0, 3.0, 1.0]) < 18


def test_a_prior_estimate_adds_what_it_knows() -> None:
    how = SECOND.over(SPEED, AFFINE)
    first = identify([response(p, i) for i, p in enumerate((0.0, 0.5, 1.0))], SECOND, how).model
    more = identify(response(0.3, 9), SECOND, how, prior=first).model
    assert np.all(np.diag(more.covariance) < np.diag(first.covariance))


def test_state_spaces_of_several_channels_from_responses() -> None:
    plant = cox_plant()
    structure = StateSpaceStructure(2, 2, 2, 1.0)
    variables = (SchedulingVariable("load", "", -1.0, 1.0),)
    omega, data = np.linspace(0.05, 3.1, 60), []
    g = np.random.default_rng(3)
    for p in (-1.0, -0.3, 0.4, 1.0):
        exact = plant.frequency_response(np.array([[p, 0.0]]), omega)[0]
        noise = 0.01 * (g.standard_normal((*exact.shape, 2)) @ [1, 1j]) / np.sqrt(2)
        data.append(FrequencyResponse(omega, exact + noise, (p,), 1.0, np.full(exact.shape, 1e-4)))
    found = identify(data, structure, structure.over(variables, AFFINE))
    assert found.outcome.ok
    between, shown = np.array([[0.1]]), np.array([0.4, 1.3])
    exact = plant.frequency_response(np.array([[0.1, 0.0]]), shown)
    error = found.model.frequency_response(between, shown) - exact
    spread = np.sqrt(np.einsum("mfyuii->mfyu", found.model.response_covariance(between, shown)))
    assert np.all(abs(error) < 4 * spread)
    assert spread.max() < 0.01
    near = replace(found.model, theta=found.model.theta * 1.01)
    again = identify(data, structure, structure.over(variables, AFFINE), start=near)
    np.testing.assert_allclose(
        again.model.frequency_response(between, shown), found.model.frequency_response(between, shown), rtol=1e-4
    )


@pytest.mark.parametrize("period", [120, None])
def test_records_along_the_scheduling(period: int | None) -> None:
    u, y, p = turbine(noise=0.02) if period else white(cox_plant(), 1500)
    variables = tuple(SchedulingVariable(f"p{i}", "", -1.0, 1.0) for i in range(p.shape[1]))
    structure = StateSpaceStructure(2, u.shape[1], y.shape[1], 1.0)
    basis = ProductBasis((Polynomial(1),) * len(variables), total_degree=1)
    found = identify(VaryingRecord(u, y, p, 1.0, period), structure, structure.over(variables, basis))
    assert found.outcome.ok
    assert np.all(np.isfinite(found.model.covariance))
    again = found.model.structure.along(found.model.coefficients(p[:400]), u[:400]).output
    assert np.linalg.norm(again - y[:400]) < 0.05 * np.linalg.norm(y[:400])


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (([], FIRST), "data"),
        ((VaryingRecord(*np.ones((3, 9)), 1.0), FIRST), "data"),
        ((record(0.5, 0, (0.5,)), FIRST, FIRST.over(SPEED, AFFINE), TwoStep(local=None), {"start": True}), "start"),
        ((response(0.5, 0), StateSpaceStructure(2), StateSpaceStructure(1).over(SPEED, AFFINE)), "dependence"),
        (
            (response(0.5, 0), StateSpaceStructure(2), StateSpaceStructure(2).over(SPEED, AFFINE), TwoStep()),
            "structure",
        ),
        ((response(0.5, 0), StateSpaceStructure(2, 2), StateSpaceStructure(2, 2).over(SPEED, AFFINE)), "data"),
        (([record(0.5, 0, (0.5,)), VaryingRecord(*np.ones((3, 9)), 1.0)], FIRST, FIRST.over(SPEED, AFFINE)), "data"),
    ],
)
def test_what_does_not_fit_is_named(arguments: tuple, field: str) -> None:
    given = [one for one in arguments if not isinstance(one, dict)]
    named = next((one for one in arguments if isinstance(one, dict)), {})
    if "start" in named:
        named = {"start": identify(record(0.5, 0, ()), FIRST).model}
    with pytest.raises(MisuseError) as caught:
        identify(*given, **named)
    assert caught.value.field == field


def test_groups_that_there_are_not_are_named() -> None:
    with pytest.raises(MisuseError, match="a1, b0"):
        FIRST.over(SPEED, AFFINE, a7=AFFINE)
    with pytest.raises(MisuseError, match="no basis"):
        FIRST.over(SPEED, a1=AFFINE)


def test_misuse_of_one_experiment_is_named_by_its_place() -> None:
    short = TimeRecord(np.ones(3), np.ones(3), 1.0, (1.0,))
    with pytest.raises(MisuseError) as caught:
        identify([record(0.0, 0, (0.0,)), short], FIRST, FIRST.over(SPEED, AFFINE))
    assert caught.value.field == "data[1]"


def test_every_method_says_what_it_takes() -> None:
    found = discover(identification.methods)
    assert {"two_step", "subspace_likelihood", "along_scheduling"} <= set(found)
    assert all(issubclass(method, Method) and method.takes.data for method in found.values())


def test_all_public_names_are_there_and_loaded_late() -> None:
    assert all(getattr(identification, name) is not None for name in identification.__all__)
    assert set(identification.__all__) <= set(dir(identification))
    with pytest.raises(AttributeError):
        identification.nothing  # noqa: B018
    code = "import sys, identification; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
