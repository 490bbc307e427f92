"""Limits of the plant over HTTP: what binds, contradictions, and bad input."""

import numpy as np
import pytest

from tests.support.api import Api, JobFailedError, Json, pointers
from tests.support.paper import FIGURES, THETA, prepared


def output_rms(experiment: Json, samples: int) -> float:
    """From the transfer function of the paper's plant itself, b z⁻¹/(1 + a z⁻¹)."""
    spectrum, (p,) = experiment["spectrum"], experiment["operatingPoint"]
    z = np.exp(1j * np.array(spectrum["frequenciesRadPerSecond"]))
    response = (THETA[2] + THETA[3] * p + 0 * z) / z / (1 + (THETA[0] + THETA[1] * p) / z)
    return float(np.sqrt(abs(response) ** 2 @ np.array(spectrum["energies"]) / samples))


@pytest.fixture(scope="module")
def body(api: Api) -> Json:
    return {**FIGURES[0].body(*prepared(api)), "spectrumFamily": {"kind": "lines", "samples": 200}, "samples": 20_000}


def test_a_limit_is_kept_and_named_with_its_price(api: Api, body: Json) -> None:
    free = api.made("/designs", body)
    highest = max(output_rms(one, 20_000) for one in free["experiments"])
    limited = api.made("/designs", {**body, "limits": [{"kind": "output_power", "rms": 0.7 * highest}]})
    assert limited["outcome"]["status"] == "converged"
    assert limited["totalEnergy"] > free["totalEnergy"]
    assert max(output_rms(one, 20_000) for one in limited["experiments"]) == pytest.approx(0.7 * highest, rel=1e-3)
    binding = [one for one in limited["binding"] if one["what"] == "limit"]
    assert binding
    assert all(one["limitIndex"] == 0 and one["operatingPoint"] and one["multiplier"] > 0 for one in binding)


def test_contradicting_limits_say_which_and_by_how_much(api: Api, body: Json) -> None:
    limits = [{"kind": "input_power", "rms": 100.0}, {"kind": "output_power", "rms": 0.01}]
    refused = api.made("/designs", {**body, "limits": limits})
    assert refused["outcome"]["status"] == "infeasible"
    assert "output's root mean square of 0.01" in refused["outcome"]["advice"]
    assert "input's" not in refused["outcome"]["advice"]
    assert "power × " in refused["outcome"]["advice"]


@pytest.mark.parametrize(
    ("limit", "pointer"),
    [
        ({"kind": "output_power", "rms": -1.0}, "/limits/0"),
        ({"kind": "output_power", "rms": 1.0, "minimumRadPerSecond": 2.0, "maximumRadPerSecond": 1.0}, "/limits/0"),
        ({"kind": "output_power", "rms": 1.0, "operatingPoints": [[0.1234]]}, "/limits/0/operatingPoints"),
        ({"kind": "input_power", "rms": 1.0, "unknown": 1.0}, "/limits/0"),
    ],
)
def test_bad_limits_are_named(api: Api, body: Json, limit: Json, pointer: str) -> None:
    problem = api.refused("/designs", {**body, "limits": [limit]})
    assert any(one.startswith(pointer) for one in pointers(problem))


def test_bands_that_leave_nothing_are_found_by_the_job(api: Api, body: Json) -> None:
    everything = {"kind": "forbidden_band", "minimumRadPerSecond": 0.0, "maximumRadPerSecond": 4.0}
    with pytest.raises(JobFailedError) as failed:
        api.made("/designs", {**body, "limits": [everything]})
    assert pointers(failed.value.problem) == ["/limits"]
