"""Models as files over HTTP: the table holds what the model says, the source compiles, what cannot be says why."""

import csv
import io

import pytest

from tests.support.api import Api, Json, pointers
from tests.support.paper import NOISE_VARIANCE, PLANT, THETA


@pytest.fixture(scope="module")
def stated(api: Api) -> Json:
    plant = api.post("/plants", {**PLANT, "name": "exported"})
    return api.post("/models/stated", {"plantId": plant["id"], "theta": THETA, "noiseVariance": NOISE_VARIANCE})


def test_coefficients_over_the_range(api: Api, stated: Json) -> None:
    text = api.download(f"/models/{stated['id']}/file", format="coefficients").decode()
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == 201
    assert set(stated["coefficientNames"]) < set(rows[0])
    assert not [name for name in rows[0] if name.startswith("sd_")]  # a stated model without covariance


def test_source_and_refusals(api: Api, stated: Json) -> None:
    source = api.download(f"/models/{stated['id']}/file", format="c").decode()
    assert "lpv_step" in source
    problem = api.problem(api.http.get(f"/models/{stated['id']}/file", params={"format": "fmu"}))
    assert pointers(problem) == ["/format"]
    assert "coefficients" in problem["detail"]
