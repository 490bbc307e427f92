"""A basis can be looked at before a plant is described with it."""

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

ONE: dict[str, Any] = {"name": "v", "unit": "m/s", "minimum": 0.0, "maximum": 4.0}
TWO: dict[str, Any] = {"name": "load", "minimum": -1.0, "maximum": 1.0}


def asked(client: TestClient, variables: list[dict[str, Any]], basis: dict[str, Any], count: int = 101) -> Any:
    return client.post("/v1/bases/values", json={"schedulingVariables": variables, "basis": basis, "count": count})


def test_powers_of_one_variable(client: TestClient) -> None:
    found = asked(client, [ONE], {"factors": [{"kind": "polynomial", "degree": 2}]}, 5).json()
    assert found["axes"] == [[0, 1, 2, 3, 4]]
    assert [one["label"] for one in found["functions"]] == ["0", "1", "2"]
    assert found["functions"][2]["values"] == [0, 1, 4, 9, 16]


def test_products_of_two_variables(client: TestClient) -> None:
    basis = {"factors": [{"kind": "polynomial", "degree": 1}, {"kind": "chebyshev", "degree": 1}], "totalDegree": 1}
    found = asked(client, [ONE, TWO], basis, 101).json()
    points = np.array(found["operatingPoints"])
    assert points.shape == (2500, 2)
    assert {one["label"]: one["values"] for one in found["functions"]}.keys() == {"0,0", "0,1", "1,0"}
    np.testing.assert_allclose(found["functions"][2]["values"], points[:, 0])


@pytest.mark.parametrize(
    ("variables", "basis", "pointer"),
    [
        ([{**ONE, "maximum": 0.0}], {"factors": [{"kind": "polynomial", "degree": 1}]}, "/schedulingVariables"),
        ([ONE, TWO], {"factors": [{"kind": "polynomial", "degree": 1}]}, "/basis"),
        ([ONE], {"factors": [{"kind": "polynomial", "degree": 4000}]}, "/basis"),
        ([ONE], {"factors": [{"kind": "polynomial", "degree": -1}]}, "/basis"),
        ([ONE], {"factors": [{"kind": "b_spline", "degree": 2, "interiorKnots": [9.0]}]}, "/basis"),
    ],
)
def test_a_basis_that_does_not_fit_is_refused_at_its_field(
    client: TestClient, variables: list[dict[str, Any]], basis: dict[str, Any], pointer: str
) -> None:
    answer = asked(client, variables, basis)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"].startswith(pointer)
