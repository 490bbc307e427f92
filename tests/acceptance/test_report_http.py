"""A report of the whole chain through HTTP, for models with and without effects."""

import html
import re

import pytest

from tests.acceptance.test_example import IDENTIFICATION
from tests.support import responses, varying
from tests.support.api import Api, Json


@pytest.fixture(scope="module")
def chain(api: Api) -> dict[str, Json]:
    example = api.made("/examples", {"hiddenEffect": "cubic_stiffness", "seed": 3})
    fitted, held_out = example["experimentIds"], example["heldOutExperimentIds"]
    model = api.made("/models", {"plantId": example["plantId"], "experimentIds": fitted, **IDENTIFICATION})
    comparison = api.made("/comparisons", {"modelId": model["id"], "experimentIds": fitted + held_out})
    diagnosis = api.made("/diagnoses", {"comparisonId": comparison["id"]})
    api.made("/diagnoses", {"comparisonId": comparison["id"], "effects": ["delay"]})
    body = {"effect": "cubic_stiffness", "experimentIds": fitted, "heldOutExperimentIds": held_out}
    body["diagnosisId"] = diagnosis["id"]
    extended = api.made(f"/models/{model['id']}/extensions", body)
    return {"example": example, "model": model, "comparison": comparison, "diagnosis": diagnosis, "extended": extended}


def test_the_report_tells_the_whole_chain(api: Api, chain: dict[str, Json]) -> None:
    report = api.made(f"/models/{chain['extended']['id']}/reports", {"name": "the stage"})
    assert report["versionIds"] == [chain["model"]["id"], chain["extended"]["id"]]
    assert report["comparisonIds"] == [chain["comparison"]["id"]]
    assert report["diagnosisIds"] == [chain["diagnosis"]["id"]]
    example = chain["example"]
    assert set(report["experimentIds"]) == {*example["experimentIds"], *example["heldOutExperimentIds"]}
    content = api.download(f"/reports/{report['id']}/file")
    assert len(content) == report["bytes"]
    page = content.decode()
    titles = [html.unescape(title) for title in re.findall(r"<h2>(.*?)</h2>", page)]
    assert titles[0] == "How the error fell"
    assert titles[-1] == "Version 2: with cubic stiffness"
    assert "<h1>the stage</h1>" in page
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", page)
    assert api.get("/reports", plantId=example["plantId"])["items"][0] == report


def test_the_file_is_saved_not_shown(api: Api, chain: dict[str, Json]) -> None:
    report = api.made(f"/models/{chain['model']['id']}/reports", {})
    answer = api.http.get(f"/reports/{report['id']}/file")
    assert answer.headers["content-type"].startswith("text/html")
    assert answer.headers["content-disposition"].startswith("attachment")
    assert report["versionIds"] == [chain["model"]["id"]]


def test_there_is_no_report_of_a_model_that_is_not_there(api: Api) -> None:
    assert api.http.post("/models/nothing/reports", json={}).status_code == 404
    assert api.http.get("/reports/nothing/file").status_code == 404


def test_models_in_state_space_and_from_varying_scheduling_have_reports_too(api: Api) -> None:
    plant = api.post("/plants", responses.PLANT)
    data = [responses.body(plant, responses.measured(point, 0.01)) for point in responses.POINTS]
    experiments = [api.made("/experiments", body)["id"] for body in data]
    estimator = {"parametricEstimator": {"kind": "parametric_subspace"}}
    body = {"plantId": plant["id"], "experimentIds": experiments, **estimator}
    model = api.made("/models/state-space", body)
    assert api.made(f"/models/{model['id']}/reports", {})["experimentIds"] == experiments

    plant = api.post("/plants", varying.TURBINE)
    record = api.made("/experiments", varying.body(plant, varying.turbine(11)))["id"]
    still = api.made("/experiments", {**varying.still(0.0, 3), "plantId": plant["id"]})["id"]
    body = {"plantId": plant["id"], "experimentId": record, "estimator": {"kind": "periodic_likelihood"}}
    model = api.made("/models/varying", body)
    api.made("/comparisons", {"modelId": model["id"], "experimentIds": [record, still]})
    report = api.made(f"/models/{model['id']}/reports", {})
    assert b"Version 1 against measurements" in api.download(f"/reports/{report['id']}/file")
