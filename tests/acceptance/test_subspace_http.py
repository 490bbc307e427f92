"""State-space models through HTTP: from uploaded responses with several inputs and outputs to a model."""

from typing import Any

import numpy as np
import pytest

from app.files import mat_writer
from identification.models.state_space_model import stacks
from tests.support import paper, responses
from tests.support.api import Api, Json, pointers

PARAMETRIC: Json = {"kind": "parametric_subspace"}
SUBSPACE: Json = {"kind": "frequency_subspace"}
INSIDE: Json = {
    "kind": "intersection",
    "regions": [{"kind": "disc", "radius": 0.95}, {"kind": "half_plane", "side": "right", "edge": -0.9}],
}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", responses.PLANT)


@pytest.fixture(scope="module")
def exact(api: Api, plant: Json) -> list[str]:
    """Noise-free responses, one uploaded in each of the ways there are."""
    names = []
    for upload, point in zip((as_json, as_npz, as_mat, as_csv), responses.POINTS, strict=True):
        names.append(upload(api, plant, point)["id"])
    return names


@pytest.fixture(scope="module")
def noisy(api: Api, plant: Json) -> list[str]:
    data = [responses.measured(point, 0.01) for point in responses.POINTS]
    return [api.made("/experiments", responses.body(plant, one))["id"] for one in data]


def as_json(api: Api, plant: Json, point: float) -> Json:
    return api.made("/experiments", responses.body(plant, responses.measured(point)))


def as_npz(api: Api, plant: Json, point: float) -> Json:
    data = responses.measured(point)
    return uploaded(api, plant, point, "a.npz", responses.npz(omega=data.frequencies, response=data.response, ts=1.0))


def as_mat(api: Api, plant: Json, point: float) -> Json:
    """As control toolboxes keep them: frequencies last."""
    data = responses.measured(point)
    arrays = {"omega": data.frequencies, "response": np.moveaxis(data.response, 0, 2), "Ts": np.array(1.0)}
    return uploaded(api, plant, point, "a.mat", mat_writer.write(arrays))


def as_csv(api: Api, plant: Json, point: float) -> Json:
    data = responses.measured(point)
    parts = [("re", data.response.real), ("im", data.response.imag)]
    columns = {f"{part}_y{y + 1}_u{u + 1}": x[:, y, u] for part, x in parts for y in (0, 1) for u in (1, 0)}
    lines = [",".join(["omega", *columns])]
    lines += [",".join(map(repr, map(float, row))) for row in zip(data.frequencies, *columns.values(), strict=True)]
    return uploaded(api, plant, point, "a.csv", "\n".join(lines).encode(), sampleTimeSeconds=1.0)


def uploaded(api: Api, plant: Json, point: float, name: str, content: bytes, **fields: Any) -> Json:
    return api.uploaded(name, content, plantId=plant["id"], operatingPoint=[point], **fields)


def identified(api: Api, plant: Json, experiments: list[str], **options: Any) -> Json:
    return api.made("/models", {"kind": "stateSpace", "plantId": plant["id"], "experimentIds": experiments, **options})


def response_of(api: Api, model: Json, point: float, **channel: int) -> tuple[np.ndarray, np.ndarray, Json]:
    band = {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 3.0, "count": 30}
    found = api.get(f"/models/{model['id']}/frequency-response", operatingPoint=[point], **band, **channel)
    return np.array(found["frequenciesRadPerSecond"]), responses.complex_array(found["response"]), found


def test_responses_come_in_alike_in_every_format(api: Api, exact: list[str]) -> None:
    for name, point in zip(exact, responses.POINTS, strict=True):
        experiment = api.get(f"/experiments/{name}")
        assert (experiment["kind"], experiment["sampleTimeSeconds"]) == ("matrixFrequencyResponse", 1.0)
        understood = experiment["understood"]
        assert (understood["outputCount"], understood["inputCount"], understood["frequencyCount"]) == (2, 2, 60)
        assert understood["frequencySpacing"] == "linear"
        kept = api.get(f"/experiments/{name}/data")
        truth = responses.measured(point)
        assert np.allclose(kept["frequenciesRadPerSecond"], truth.frequencies, rtol=1e-15)
        assert np.allclose(responses.complex_array(kept["response"]), truth.response, rtol=1e-15)


@pytest.mark.parametrize("file_format", ["csv", "npz", "mat"])
def test_what_comes_out_can_be_brought_in_again(api: Api, plant: Json, noisy: list[str], file_format: str) -> None:
    content = api.download(f"/experiments/{noisy[1]}/file", format=file_format)
    again = uploaded(api, plant, responses.POINTS[1], f"again.{file_format}", content)
    first, second = (api.get(f"/experiments/{name}/data") for name in (noisy[1], again["id"]))
    assert first == second
    assert again["varianceKnown"]


def test_noise_free_responses_give_the_plant_itself(api: Api, plant: Json, exact: list[str]) -> None:
    model = identified(api, plant, exact, parametricEstimator={**PARAMETRIC, "weighting": "none"})
    found = model["stateSpace"]
    truth = responses.true_plant()
    for name, matrices in zip("ABCD", stacks(truth), strict=True):
        assert np.allclose(found["matrices"][f"matrix{name}"], matrices, atol=1e-9), name
    assert found["chosenRows"]["counts"] == [2, 1]
    assert 0 < found["chosenRows"]["worstSingularValue"] <= 1
    assert [error["experimentId"] for error in found["errors"]] == exact
    assert max(error["maxError"] for error in found["errors"]) < 1e-9
    assert all(values["values"][3] < 1e-9 * values["values"][2] for values in found["singularValues"])
    assert (found["order"], found["inputCount"], found["outputCount"], found["sampleTimeSeconds"]) == (3, 2, 2, 1.0)
    assert (model["stable"], model["outcome"]["status"], model.get("covariance")) == (True, "converged", None)
    assert np.array(model["theta"]).shape == (len(model["parameterNames"]),)
    assert dict(zip(model["parameterNames"], model["theta"], strict=True))["A[1](3,2)"] == pytest.approx(0.03)
    poles = {one["operatingPoint"][0]: np.sort(responses.complex_array(one["poles"])) for one in model["poles"]}
    assert np.allclose(poles[1.0], np.sort(truth.poles([[1.0]])[0]), atol=1e-8)


@pytest.mark.parametrize(("output", "input"), [(1, 1), (1, 2), (2, 1), (2, 2)])
def test_each_channel_has_its_frequency_response(
    api: Api, plant: Json, exact: list[str], output: int, input: int
) -> None:
    model = identified(api, plant, exact, parametricEstimator=PARAMETRIC)
    omega, found, document = response_of(api, model, 1.7, outputNumber=output, inputNumber=input)
    truth = responses.true_plant().frequency_response([[1.7]], omega)[0, :, output - 1, input - 1]
    assert np.allclose(found, truth, atol=1e-9)
    assert (document["outputNumber"], document["inputNumber"]) == (output, input)
    assert "magnitudeLower95" not in document
    assert "realVariance" not in document


def test_pole_regions_are_guaranteed_over_the_whole_range(api: Api, plant: Json, noisy: list[str]) -> None:
    tight = {"kind": "intersection", "regions": [{"kind": "disc", "radius": 0.8}, {"kind": "strip", "halfHeight": 0.5}]}
    model = identified(api, plant, noisy, parametricEstimator={**PARAMETRIC, "region": tight})
    guarantee = model["stateSpace"]["poleGuarantee"]
    assert (guarantee["guaranteed"], guarantee["operatingPoints"]) == ("wholeRange", 2)
    assert guarantee["certificate"] < 0
    assert guarantee["worstExcess"] < 0 < guarantee["worstExcessWithoutRegion"]
    assert guarantee["relativeError"] > guarantee["relativeErrorWithoutRegion"]
    poles = np.concatenate([responses.complex_array(one["poles"]) for one in model["poles"]])
    assert abs(poles).max() < 0.8
    assert abs(poles.imag).max() < 0.5
    assert model["stateSpace"]["parametricEstimator"]["region"]["regions"][1]["halfHeight"] == 0.5


def test_a_polynomial_dependence_is_guaranteed_on_a_grid_only(api: Api, plant: Json, noisy: list[str]) -> None:
    parabola = {"factors": [{"kind": "polynomial", "degree": 2}]}
    estimator = {**PARAMETRIC, "region": INSIDE, "gridCount": 9}
    model = identified(api, plant, noisy, parametricEstimator=estimator, basis=parabola)
    guarantee = model["stateSpace"]["poleGuarantee"]
    assert (guarantee["guaranteed"], guarantee["operatingPoints"]) == ("grid", 9)
    assert "nothing is proved" in model["outcome"]["advice"]
    assert [len(model["stateSpace"]["matrices"][f"matrix{name}"]) for name in "ABCD"] == [3, 3, 3, 3]


def test_a_region_that_the_data_exclude_is_infeasible_by_so_much(api: Api, plant: Json, noisy: list[str]) -> None:
    far = {"kind": "disc", "radius": 0.1, "centre": -0.5}
    model = identified(api, plant, noisy, parametricEstimator={**PARAMETRIC, "region": far})
    assert model["outcome"]["status"] == "infeasible"
    assert "without the region the relative error is" in model["outcome"]["advice"]


def test_refinement_gives_a_covariance_and_bands_that_hold(api: Api, plant: Json, noisy: list[str]) -> None:
    refinement = {"kind": "state_space_likelihood"}
    model = identified(api, plant, noisy, parametricEstimator=PARAMETRIC, refinement=refinement)
    assert (model["outcome"]["status"], model["noiseVariance"]) == ("converged", 1.0)
    assert len(model["standardDeviations"]) == len(model["theta"]) == len(model["covariance"]) == 18 + 6 + 6 + 4
    assert model["tests"][0]["pValue"] > 1e-3
    omega, found, document = response_of(api, model, 1.0, outputNumber=2)
    truth = responses.true_plant().frequency_response([[1.0]], omega)[0, :, 1, 0]
    normalised = abs(found.real - truth.real) / np.sqrt(document["realVariance"])
    assert 0.05 < np.sqrt(np.mean(normalised**2)) < 3
    assert np.all(np.array(document["magnitudeLower95"]) < np.array(document["magnitude"]))


def test_the_order_is_chosen_at_an_operating_point(api: Api, plant: Json, noisy: list[str]) -> None:
    structure = {**responses.STRUCTURE, "order": None}
    model = identified(api, plant, noisy[:2], subspaceEstimator=SUBSPACE, structure=structure)
    local = model["stateSpace"]["localModels"]
    assert [one["order"] for one in local] == [3, 3]
    table = local[0]["orderTable"]
    assert [row["order"] for row in table][:4] == [1, 2, 3, 4]
    assert table[1]["heldOutRmsError"] > 2 * table[2]["heldOutRmsError"]
    assert local[0]["singularValues"][2] > 5 * local[0]["singularValues"][3]
    assert local[0]["rmsError"] == pytest.approx(0.02, rel=0.3)
    assert local[0]["maxError"] > local[0]["rmsError"]
    assert model["theta"] == []
    assert "matrices" not in model["stateSpace"]
    assert "noiseVariance" not in model
    omega, found, _ = response_of(api, model, responses.POINTS[1], inputNumber=2)
    truth = responses.true_plant().frequency_response([[responses.POINTS[1]]], omega)[0, :, 0, 1]
    assert np.linalg.norm(found - truth) < 0.02 * np.linalg.norm(truth)
    answer = api.http.get(f"/models/{model['id']}/frequency-response", params=query(operatingPoint=1.0))
    assert "single operating points" in api.problem(answer)["detail"]


def query(**more: Any) -> Json:
    return {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 3.0, **more}


def test_continuous_time_and_one_channel(api: Api) -> None:
    """A plant with one input and output takes ordinary frequency responses, also for two operating points at once."""
    omega = np.geomspace(0.01, 100, 80)
    plant = api.post(
        "/plants",
        {
            **responses.PLANT,
            "inputs": [{"name": "u"}],
            "outputs": [{"name": "y"}],
            "structure": {"timeDomain": "continuousStateSpace", "order": 2},
        },
    )
    experiments = []
    for p in (0.0, 2.0):
        response = (2 + 1j * omega) / ((1j * omega) ** 2 + (0.3 + 0.1 * p) * 1j * omega + 1 + p)
        request = {"plantId": plant["id"], "kind": "frequencyResponse", "operatingPoint": [p]}
        request |= {"frequenciesRadPerSecond": omega.tolist(), "response": responses.complex_json(response)}
        experiments.append(api.made("/experiments", request)["id"])
    model = identified(api, plant, experiments, parametricEstimator=PARAMETRIC, subspaceEstimator=SUBSPACE)
    assert np.allclose([one["relativeError"] for one in model["stateSpace"]["localModels"]], 0, atol=1e-8)
    middle = next(one for one in model["poles"] if one["operatingPoint"] == [1.0])
    assert np.allclose(np.sort(responses.complex_array(middle["poles"])), np.sort(np.roots([1, 0.4, 2])), atol=1e-6)


def test_requests_for_the_other_sort_of_model_say_where_to_go(api: Api, plant: Json, exact: list[str]) -> None:
    estimators = {"localEstimator": {"kind": "rational_fit"}, "lpvEstimator": {"kind": "generalised_least_squares"}}
    problem = api.refused("/models", {"plantId": plant["id"], "experimentIds": exact, **estimators})
    assert pointers(problem) == ["/plantId"]
    assert "stateSpace" in problem["detail"]
    stated = {"plantId": plant["id"], "theta": [1.0], "noiseVariance": 1.0}
    assert pointers(api.refused("/models/stated", stated)) == ["/plantId"]
    model = identified(api, plant, exact, parametricEstimator=PARAMETRIC)
    design = {**paper.FIGURES[0].body(plant, model), "operatingPoints": paper.only(0.0)}
    assert pointers(api.refused("/designs", design)) == ["/modelId"]
    held_against = {"modelId": model["id"], "experimentIds": exact}
    assert pointers(api.refused("/comparisons", held_against)) == ["/modelId"]
    assert pointers(api.refused("/diagnoses", held_against)) == ["/modelId"]
    answer = api.http.get(f"/models/{model['id']}/frequency-response", params=query(operatingPoint=1.0, outputNumber=3))
    assert pointers(api.problem(answer)) == ["/outputNumber"]


def test_the_catalogue_has_what_can_be_chosen(api: Api) -> None:
    catalogue = api.get("/catalogue")
    kinds = {name: [entry["kind"] for entry in catalogue[name]] for name in catalogue if name != "softwareVersion"}
    assert {"equidistant_subspace", "frequency_subspace"} <= set(kinds["subspaceEstimators"])
    assert "parametric_subspace" in kinds["parametricEstimators"]
    assert kinds["poleRegions"] == ["cone", "disc", "half_plane", "intersection", "strip"]
    entry = next(one for one in catalogue["parametricEstimators"] if one["kind"] == "parametric_subspace")
    options = {option["name"]: option for option in entry["options"]}
    assert "order" not in options
    assert "DiscRegion" in options["region"]["valueSchema"]["$defs"]
