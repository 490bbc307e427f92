"""A data directory of an earlier version is read, and walked on from."""

from collections.abc import Iterator

import pytest

from tests.support.api import Api, Json
from tests.support.old_data import unpacked
from tests.support.patience import until
from tests.support.server import running_server

COUNTS = {
    "plants": 4,
    "experiments": 21,
    "models": 5,
    "designs": 1,
    "signals": 1,
    "comparisons": 2,
    "diagnoses": 3,
    "staircases": 1,
    "simulations": 1,
    "reports": 1,
    "examples": 1,
}
DATA = {"experiments": "/data", "simulations": "/data", "comparisons": "/maps", "reports": "/file", "signals": "/file"}


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    with running_server(unpacked(tmp_path_factory.mktemp("old") / "data")) as server:
        yield Api(server.url)


def everything(api: Api, kind: str) -> list[Json]:
    found: list[Json] = api.get(f"/{kind}", limit=100)["items"]
    return found


def test_what_was_running_or_waiting_is_done(api: Api) -> None:
    def ended() -> list[Json] | None:
        jobs = everything(api, "jobs")
        return None if any(job["state"] in ("queued", "running") for job in jobs) else jobs

    jobs = until(ended, "the end of all jobs")
    assert {job["state"] for job in jobs} == {"succeeded"}
    names = [one["name"] for kind in ("staircases", "comparisons") for one in everything(api, kind)]
    assert {"cut off", "waiting"} <= set(names)


@pytest.mark.parametrize("kind", COUNTS)
def test_every_resource_is_read_with_its_arrays(api: Api, kind: str) -> None:
    found = everything(api, kind)
    assert len(found) >= COUNTS[kind]
    for one in found:
        assert api.get(f"/{kind}/{one['id']}") == one
        if kind in DATA:
            assert len(api.download(f"/{kind}/{one['id']}{DATA[kind]}")) > 100


def test_models_of_every_kind_answer_and_are_walked_on_from(api: Api) -> None:
    models = {one["name"] or one["origin"]: one for one in everything(api, "models")}
    for model in models.values():
        band = {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 1.0, "count": 5}
        ends = api.get(f"/plants/{model['plantId']}")["schedulingVariables"]
        point = [ends[0]["minimum"]]
        assert api.get(f"/models/{model['id']}/frequency-response", operatingPoint=point, **band)
    extended = next(one for one in models.values() if one["origin"] == "extended")
    again = api.made("/diagnoses", {"modelId": extended["id"], "experimentIds": extended["experimentIds"]})
    assert "coulomb_friction" not in again["announced"]
