"""The example of [Ghosh2018, Section 5] through HTTP: energies, operating points and certificates."""

import numpy as np
import pytest

from tests.support.api import Api, Json, pointers
from tests.support.paper import (
    BOX,
    FIGURES,
    LINES,
    NOISE_VARIANCE,
    THETA,
    Figure,
    energies,
    fir,
    only,
    prepared,
)


@pytest.fixture(scope="module")
def made(api: Api) -> dict[str, Json]:
    """All designs by their names, submitted together."""
    plant, model = prepared(api)
    jobs = {figure.name: api.post("/designs", figure.body(plant, model)) for figure in FIGURES}
    return {name: api.result(job) for name, job in jobs.items()}


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.name)
def test_energy_is_that_of_the_paper_and_certified(figure: Figure, made: dict[str, Json]) -> None:
    design = made[figure.name]
    assert design["outcome"]["status"] == "converged"
    assert design["totalEnergy"] == pytest.approx(figure.energy, rel=1e-3)
    assert 0 <= design["gap"] <= 1e-4
    assert design["lowerBound"] == pytest.approx(design["totalEnergy"] * (1 - design["gap"]), rel=1e-9)
    assert sum(energies(design).values()) == pytest.approx(design["totalEnergy"], rel=1e-6)
    assert design["samples"] == max(1000, int(design["requiredSamples"]) + 1)


@pytest.mark.parametrize("figure", [f for f in FIGURES if f.energies], ids=lambda figure: figure.name)
def test_operating_points_are_those_of_the_paper_and_no_others(figure: Figure, made: dict[str, Json]) -> None:
    found = energies(made[figure.name])
    assert set(found) == set(figure.energies)
    for point, energy in figure.energies.items():
        if energy:
            assert found[point] == pytest.approx(energy, rel=1e-2)


def test_the_duration_asked_for_is_enough_for_the_noise_model_of_the_optimum(made: dict[str, Json]) -> None:
    assert made["17 points, L = 10"]["samples"] == 1000
    assert made["Table 1, 0 and 1.5"]["samples"] > 1000


def test_line_spectra_need_the_least_energy(made: dict[str, Json]) -> None:
    assert made["17 points, lines"]["totalEnergy"] <= 2855.5
    assert made["p free, lines"]["totalEnergy"] <= made["17 points, lines"]["totalEnergy"] * (1 + 1e-4)


def test_free_operating_points_stand_where_the_theory_puts_them(made: dict[str, Json]) -> None:
    points = sorted(energies(made["p free, lines"]))
    assert points == pytest.approx([0.0, 1.475, 8.0], abs=0.03)
    lines = {e["operatingPoint"][0]: e["spectrum"] for e in made["p free, lines"]["experiments"]}
    assert lines[points[1]]["frequenciesRadPerSecond"] == pytest.approx([0.0], abs=1e-9)
    strongest = max(zip(lines[0.0]["energies"], lines[0.0]["frequenciesRadPerSecond"], strict=True))[1]
    assert strongest == pytest.approx(0.100, abs=0.01)


def test_expected_accuracy_meets_the_targets(made: dict[str, Json]) -> None:
    design = made["17 points, L = 10"]
    wanted = design["request"]["targets"][0]["standardDeviations"]
    assert all(
        got <= asked * (1 + 1e-6) for got, asked in zip(design["expectedStandardDeviations"], wanted, strict=True)
    )
    assert [b["what"] for b in made["at most 1000 a point"]["binding"]].count("cap") == 3


def test_a_box_inside_the_range_is_searched_inside_only(api: Api) -> None:
    plant, model = prepared(api)
    below = Figure("box below 5", 0.0, points={**BOX, "maximum": [5.0]}, family=LINES)
    design = api.made("/designs", below.body(plant, model))
    assert max(energies(design)) <= 5.0
    assert design["totalEnergy"] > 1.5 * 2855


def test_excluded_points_are_avoided(api: Api) -> None:
    plant, model = prepared(api)
    design = api.made("/designs", {**FIGURES[0].body(plant, model), "excludedPoints": [[1.5], [8.0]]})
    assert not {1.5, 8.0} & set(energies(design))
    assert design["totalEnergy"] > 3510.4


def test_the_same_request_under_one_key_is_one_job(api: Api) -> None:
    plant, model = prepared(api)
    body, headers = FIGURES[0].body(plant, model), {"Idempotency-Key": plant["id"]}
    first, again = (api.http.post("/designs", json=body, headers=headers) for _ in range(2))
    assert first.status_code == again.status_code == 202
    assert first.json()["id"] == again.json()["id"]
    assert first.headers["location"] == f"/v1/jobs/{first.json()['id']}"
    other = api.http.post("/designs", json={**body, "samples": 2000}, headers=headers)
    assert api.problem(other)["status"] == 409


def test_a_promise_is_kept_and_checked(api: Api) -> None:
    plant, unknown = prepared(api)
    covariance = np.diag(np.array([0.006, 0.0008, 0.12, 0.02, 0.05, 0.01]) ** 2).tolist()
    stated = {"plantId": plant["id"], "theta": THETA, "noiseVariance": NOISE_VARIANCE, "covariance": covariance}
    figure = Figure("promised", 0.0, points=only(0, 2, 8), family=fir(4))
    asked = {"promise": {"probability": 0.9, "seed": 4}}
    design = api.made("/designs", {**figure.body(plant, api.post("/models/stated", stated)), **asked})
    promise = design["promise"]
    assert design["outcome"]["status"] == "converged"
    assert promise["lowestProbability"] < promise["kept"] / promise["checked"] < promise["highestProbability"]
    assert promise["kept"] / promise["checked"] >= 0.87
    assert design["totalEnergy"] > promise["energyAtEstimate"]
    assert design["lowerBound"] <= promise["energyAtEstimate"] * (1 + 1e-9)
    assert pointers(api.refused("/designs", {**figure.body(plant, unknown), **asked})) == ["/promise"]
