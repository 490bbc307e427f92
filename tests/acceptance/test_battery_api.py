"""Impedance of a battery cell at 13 states of charge through HTTP: local models, then one over the state of charge."""

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

from identification.arrays import ComplexArray, FloatArray
from tests.support.api import Api, Json

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "eis_battery_13_states_of_charge"
SCALE = 50.0
Spectra = dict[float, tuple[FloatArray, ComplexArray]]


@pytest.fixture(scope="module")
def spectra() -> Spectra:
    """Frequencies in rad/s and impedance in ohm at each state of charge in %."""
    path = DATA / "imiev_15C_eis.csv"
    if not path.is_file():
        pytest.skip(f"the measured battery data are not at {path}")
    rows = defaultdict(list)
    with path.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            impedance = complex(float(row["Zre_ohm"]), float(row["Zim_ohm"]))
            rows[float(row["soc_pct"])].append((2 * np.pi * float(row["freq_Hz"]), impedance))
    return {soc: (np.array([w for w, _ in some]), np.array([z for _, z in some])) for soc, some in rows.items()}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post(
        "/plants",
        {
            "name": "battery cell",
            "schedulingVariables": [{"name": "state of charge", "unit": "%", "minimum": 5.0, "maximum": 95.0}],
            "input": {"name": "current", "unit": "A"},
            "output": {"name": "voltage", "unit": "V"},
            "structure": structure(1, 1),
            "basis": {"factors": [{"kind": "chebyshev", "degree": 6}]},
        },
    )


@pytest.fixture(scope="module")
def experiments(api: Api, plant: Json, spectra: Spectra) -> list[str]:
    made = []
    for soc, (omega, impedance) in spectra.items():
        body = {
            "kind": "frequencyResponse",
            "plantId": plant["id"],
            "operatingPoint": [soc],
            "frequenciesRadPerSecond": omega.tolist(),
            "response": {"re": impedance.real.tolist(), "im": impedance.imag.tolist()},
        }
        made.append(api.made("/experiments", body)["id"])
    return made


def structure(na: int, nb: int) -> Json:
    return {"timeDomain": "continuous", "na": na, "nb": nb, "frequencyScaleRadPerSecond": SCALE}


@pytest.fixture(scope="module")
def models(api: Api, plant: Json, experiments: list[str]) -> dict[str, Json]:
    """A resistor and one RC arc; a resistor, an inductance and two RC arcs."""
    body = {
        "plantId": plant["id"],
        "experimentIds": experiments,
        "localEstimator": {"kind": "rational_fit", "weighting": "relative", "relaxation": True},
        "lpvEstimator": {"kind": "joint_likelihood"},
    }
    return {
        "one arc": api.made("/models", body),
        "two arcs": api.made("/models", {**body, "structure": structure(2, 3)}),
    }


def relative_error(model: Json, zeta: FloatArray, omega: FloatArray, impedance: ComplexArray) -> float:
    """Root mean square of |Z − B/A|/|Z|."""
    na, nb = model["structure"]["na"], model["structure"]["nb"]
    x = 1j * omega / model["structure"]["frequencyScaleRadPerSecond"]
    a = np.polyval(np.concatenate([[1.0], zeta[:na]]), x)
    b = np.polyval(zeta[na : na + nb + 1], x)
    return float(np.sqrt(np.mean(abs(1 - b / a / impedance) ** 2)))


def over_range(model: Json, spectra: Spectra) -> list[float]:
    """The errors of the parameter-varying model at the measured states of charge."""
    size = len(model["theta"]) // len(model["coefficientNames"])
    theta = np.array(model["theta"]).reshape(-1, size)
    errors = []
    for soc, (omega, impedance) in spectra.items():
        zeta = theta @ np.polynomial.chebyshev.chebvander((2 * soc - 100.0) / 90.0, size - 1).ravel()
        errors.append(relative_error(model, zeta, omega, impedance))
    return errors


def test_a_response_is_understood(api: Api, experiments: list[str]) -> None:
    understood = api.get(f"/experiments/{experiments[0]}")["understood"]
    assert understood["frequencyCount"] == 56
    assert understood["minimumFrequencyRadPerSecond"] == pytest.approx(2 * np.pi * 1e-3, rel=0.01)


def test_one_arc_does_what_it_can_at_half_charge(models: dict[str, Json], spectra: Spectra) -> None:
    """34.8 % with positive resistances and capacitance."""
    local = next(one for one in models["one arc"]["localModels"] if one["operatingPoint"] == [50.0])
    assert local["relativeError"] == pytest.approx(0.348, abs=0.001)
    zeta = np.array(local["zeta"])
    assert relative_error(models["one arc"], zeta, *spectra[50.0]) == pytest.approx(local["relativeError"], rel=1e-9)


def test_every_local_model_is_found(models: dict[str, Json], experiments: list[str]) -> None:
    for model in models.values():
        assert [local["experimentId"] for local in model["localModels"]] == experiments
        assert {local["outcome"]["status"] for local in model["localModels"]} == {"converged"}


def test_the_model_over_the_state_of_charge_has_its_covariance(models: dict[str, Json], spectra: Spectra) -> None:
    for model in models.values():
        covariance = np.array(model["covariance"])
        k = 7 * len(model["coefficientNames"])
        assert covariance.shape == (k, k)
        scaled = covariance / np.outer(model["standardDeviations"], model["standardDeviations"])
        assert np.linalg.eigvalsh(scaled)[0] > 0
        assert model["outcome"]["status"] == "converged"
        assert model["stable"]


def test_a_higher_order_does_visibly_better(models: dict[str, Json], spectra: Spectra) -> None:
    half = {
        name: next(one for one in model["localModels"] if one["operatingPoint"] == [50.0])["relativeError"]
        for name, model in models.items()
    }
    assert half["two arcs"] == pytest.approx(0.100, abs=0.001)
    errors = {name: over_range(model, spectra) for name, model in models.items()}
    assert np.mean(errors["two arcs"]) < 0.6 * np.mean(errors["one arc"])


def test_the_original_mat_file_gives_the_same_response(api: Api, plant: Json, spectra: Spectra) -> None:
    content = (DATA / "raw" / "MiEV_50Ah_001_0C_DC_15grad_50SOC.mat").read_bytes()
    stated = {"plantId": plant["id"], "operatingPoint": [50.0], "variableGroup": "DRT_GUI.Messdaten"}
    data = api.get(f"/experiments/{api.uploaded('50SOC.mat', content, **stated)['id']}/data")
    order = np.argsort(data["frequenciesRadPerSecond"])
    np.testing.assert_allclose(np.array(data["response"]["re"])[order], spectra[50.0][1].real, rtol=1e-6)
