"""The measured response over HTTP: of records with and without a period, of responses, and impedances tested."""

import numpy as np
import pytest

from tests.support.api import Api
from tests.support.server import Server

PLANT = {
    "name": "cell",
    "input": {"name": "current", "unit": "A"},
    "output": {"name": "voltage", "unit": "mV"},
    "schedulingVariables": [{"name": "charge", "unit": "%", "minimum": 0, "maximum": 100}],
    "structure": {"timeDomain": "continuous", "na": 1, "nb": 1},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
OMEGA = 2 * np.pi * np.geomspace(0.1, 1000, 41)


@pytest.fixture
def api(server: Server) -> Api:
    return Api(server.url)


def impedance(sign: float) -> dict[str, object]:
    z = 20 + 15 / (1 + (0.02j * OMEGA) ** 0.8)
    noise = np.random.default_rng(2).standard_normal((2, len(OMEGA)))
    z = z + 1e-3 * abs(z) * (noise[0] + 1j * noise[1])
    return {
        "kind": "frequencyResponse",
        "frequenciesRadPerSecond": OMEGA.tolist(),
        "response": {"re": z.real.tolist(), "im": (sign * z.imag).tolist()},
        "variance": (2e-6 * abs(z) ** 2).tolist(),
        "operatingPoint": [50.0],
    }


def test_impedances_are_tested_and_a_wrong_sign_is_seen(api: Api) -> None:
    plant = api.post("/plants", PLANT)["id"]
    right, wrong = (api.made("/experiments", {**impedance(s), "plantId": plant}) for s in (1.0, -1.0))
    found = api.get(f"/experiments/{right['id']}/frequency-response")
    assert found["method"] == "given"
    np.testing.assert_allclose(found["response"]["im"], impedance(1.0)["response"]["im"])  # type: ignore[index]
    assert found["kramersKronig"]["pValue"] > 1e-3
    assert found["kramersKronig"]["size"] == pytest.approx(1.4e-3, rel=0.4)
    mistaken = api.get(f"/experiments/{wrong['id']}/frequency-response")["kramersKronig"]
    assert mistaken["pValue"] < 1e-6
    assert mistaken["conjugateSize"] < 0.1 * mistaken["size"]


def test_a_response_of_motion_is_no_impedance_and_records_have_one(api: Api) -> None:
    named = {**PLANT, "input": {"name": "force", "unit": "N"}, "output": {"name": "way", "unit": "mm"}}
    plant = api.post("/plants", named)["id"]
    generator = np.random.default_rng(7)
    for u, method in (
        (np.tile(generator.standard_normal(200), 5), "periodicAverage"),
        (generator.standard_normal(1000), "localPolynomial"),
    ):
        y = 2.5 * u + 0.01 * generator.standard_normal(len(u))
        record = {"kind": "timeRecord", "sampleTimeSeconds": 0.1, "input": u.tolist(), "output": y.tolist()}
        made = api.made("/experiments", {**record, "plantId": plant, "operatingPoint": [50.0]})
        found = api.get(f"/experiments/{made['id']}/frequency-response")
        assert found["method"] == method
        assert found.get("kramersKronig") is None
        np.testing.assert_allclose(found["response"]["re"], 2.5, atol=0.05)
        assert np.median(found["standardDeviation"]) < 0.02
