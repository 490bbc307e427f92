"""A file is looked into before anything is made of it: columns, units, what is asked, what is remembered."""

import numpy as np
import pytest

from app.files.csv_writer import write
from tests.support.api import Api, JobFailedError, Json, pointers

F = np.logspace(-1, 2, 30)
Z = 1 / (1 + 0.5j * 2 * np.pi * F)
PLANT: Json = {
    "name": "looked into",
    "schedulingVariables": [{"name": "soc", "minimum": 0.0, "maximum": 100.0}],
    "input": {"name": "current", "unit": "A"},
    "output": {"name": "voltage", "unit": "V"},
    "structure": {"timeDomain": "continuous", "na": 1, "nb": 1},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
BARE = write({"Frequency": F, "Zre": Z.real, "-Zim": -Z.imag})


@pytest.fixture
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


def looked(api: Api, plant: Json, name: str, content: bytes, **fields: object) -> Json:
    answer = api.http.post("/previews", data={"plantId": plant["id"], **fields}, files={"file": (name, content)})
    assert answer.status_code == 202, answer.text
    return api.result(answer.json())


def count(api: Api, plant: Json) -> int:
    return len(api.get("/experiments", plantId=plant["id"])["items"])


def test_a_question_is_asked_answered_and_remembered(api: Api, plant: Json) -> None:
    asked = looked(api, plant, "a.csv", BARE)
    assert asked["problem"]["pointer"] == "/units"
    assert "Frequency=Hz or Frequency=rad/s" in asked["problem"]["detail"]
    assert "kind" not in asked
    seen = {one["name"]: one for one in asked["columns"]}
    assert [seen[name]["takenFor"] for name in ("Frequency", "Zre", "-Zim")] == ["frequency", "real", "imaginary"]
    assert seen["-Zim"]["sign"] == -1
    assert len(seen["Zre"]["firstValues"]) == 8
    answered = looked(api, plant, "a.csv", BARE, units=["Frequency=Hz"])
    assert "problem" not in answered
    assert answered["kind"] == "frequencyResponse"
    assert answered["picture"]["abscissa"] == "frequenciesRadPerSecond"
    np.testing.assert_allclose(answered["picture"]["values"], 2 * np.pi * F)
    np.testing.assert_allclose(answered["picture"]["curves"][0]["values"], 20 * np.log10(abs(Z)), atol=1e-9)
    assert count(api, plant) == 0
    api.uploaded("a.csv", BARE, plantId=plant["id"], operatingPoint=[50.0], units=["Frequency=Hz"])
    again = looked(api, plant, "b.csv", BARE)
    assert again["remembered"] is True
    assert again["statedUnits"] == ["Frequency=Hz"]
    assert again["kind"] == "frequencyResponse"
    other = looked(api, plant, "c.csv", write({"f (Hz)": F, "re": Z.real, "im": Z.imag}))
    assert other["remembered"] is False
    assert other["kind"] == "frequencyResponse"


def test_a_record_is_seen_with_its_channels_and_units(api: Api, plant: Json) -> None:
    time = np.arange(4000) * 1e-3
    content = write({"t (ms)": 1e3 * time, "I (mA)": 1e3 * np.sin(time), "U (V)": np.cos(time), "note": 0 * time})
    seen = looked(api, plant, "record.csv", content)
    assert seen["kind"] == "timeRecord"
    assert seen["sampleTimeSeconds"] == pytest.approx(1e-3)
    assert [one["takenFor"] for one in seen["columns"]] == ["time", "input", "output", ""]
    assert len(seen["picture"]["values"]) <= 500
    assert max(seen["picture"]["curves"][0]["values"]) == pytest.approx(1.0, abs=0.01)


def test_long_tables_become_one_experiment_each(api: Api, plant: Json) -> None:
    point = np.repeat([10.0, 20.0], 30)
    both = np.tile(Z, 2) * point
    table = {"soc_pct": point, "f_Hz": np.tile(F, 2), "re": both.real, "im": both.imag}
    stated = {"plantId": plant["id"], "operatingPointColumns": ["soc_pct"]}
    made = api.uploaded("all.csv", write(table), **stated)
    assert made["operatingPoint"] == [10.0]
    (sibling,) = made["siblingIds"]
    other = api.get(f"/experiments/{sibling}")
    assert other["operatingPoint"] == [20.0]
    assert other["name"] == "at 20"
    data = api.get(f"/experiments/{sibling}/data")
    np.testing.assert_allclose(data["response"]["re"], 20 * Z.real)
    with pytest.raises(JobFailedError) as failure:
        api.uploaded("all.csv", write({**table, "soc_pct": 10 * point}), **stated)
    assert "outside the plant's range" in failure.value.problem["detail"]


def test_what_cannot_be_looked_into_says_why(api: Api, plant: Json) -> None:
    with pytest.raises(JobFailedError) as failure:
        looked(api, plant, "a.xlsx", b"PK none")
    assert "save it as .xlsx" in failure.value.problem["detail"]
    answer = api.http.post("/previews", data={"plantId": plant["id"], "unit": "a=b"}, files={"file": ("a.csv", BARE)})
    assert pointers(api.problem(answer)) == ["/unit"]
