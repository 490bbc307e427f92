"""Requests for designs as problems of oed."""

import numpy as np
import pytest

from app.conversion.designs import candidate_points, energy_caps, prior_information, searched_model
from app.conversion.plants import lpv_model, structure_and_dependence
from app.schemas.designs import DesignRequest
from app.schemas.plants import PlantRequest
from identification.errors import MisuseError, RangeError
from identification.models.model import Model
from tests.support.paper import PLANT, THETA

REQUEST = {
    "plantId": "p",
    "modelId": "m",
    "operatingPoints": {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 8.0, "count": 5}]},
    "targets": [{"kind": "parameter_deviation", "standardDeviations": [0.1] * 6}],
    "spectrumFamily": {"kind": "fir", "degree": 3},
    "samples": 100,
}


def request(**changes: object) -> DesignRequest:
    return DesignRequest.model_validate({**REQUEST, **changes})


def model(basis: dict[str, object] | None = None) -> Model:
    plant = PlantRequest.model_validate({**PLANT, "basis": {"factors": [basis]} if basis else PLANT["basis"]})
    structure, dependence = structure_and_dependence(plant)
    return lpv_model(structure, dependence, THETA, np.diag(np.arange(1.0, 7.0) ** 2).tolist(), 0.5)


def test_grids_leave_excluded_points_out() -> None:
    points = candidate_points(request(excludedPoints=[[2.0], [8.0]]), model().dependence)
    assert points.tolist() == [[0.0], [4.0], [6.0]]


def test_grids_of_two_axes_are_products() -> None:
    two = {**PLANT, "schedulingVariables": [{"name": n, "minimum": 0.0, "maximum": 1.0} for n in "ab"]}
    basis = {"factors": [{"kind": "polynomial", "degree": 1}] * 2, "totalDegree": 1}
    _, dependence = structure_and_dependence(PlantRequest.model_validate({**two, "basis": basis}))
    axes = [{"minimum": 0.0, "maximum": 1.0, "count": 2}, {"minimum": 0.5, "maximum": 0.5, "count": 1}]
    points = candidate_points(request(operatingPoints={"kind": "gridAxes", "axes": axes}), dependence)
    assert points.tolist() == [[0.0, 0.5], [1.0, 0.5]]


def test_caps_find_their_points() -> None:
    points = np.array([[0.0], [4.0], [8.0]])
    caps = {"default": 7.0, "perPoint": [{"operatingPoint": [4.0], "energy": 2.0}]}
    found = energy_caps(request(energyCaps=caps), points, model().dependence)
    assert found is not None
    assert found.tolist() == [7.0, 2.0, 7.0]
    assert energy_caps(request(energyCaps={}), points, model().dependence) is None
    elsewhere = {"perPoint": [{"operatingPoint": [5.0], "energy": 2.0}]}
    with pytest.raises(RangeError, match="none of the operating points"):
        energy_caps(request(energyCaps=elsewhere), points, model().dependence)


@pytest.mark.parametrize("kind", ["polynomial", "chebyshev"])
def test_a_model_over_a_box_is_the_same_model(kind: str) -> None:
    whole = model({"kind": kind, "degree": 1})
    box = {"kind": "box", "minimum": [1.0], "maximum": [5.0]}
    part = searched_model(request(operatingPoints=box), whole)
    points = [[1.0], [2.5], [5.0]]
    np.testing.assert_allclose(part.coefficients(points), whole.coefficients(points), rtol=1e-14)
    with pytest.raises(RangeError):
        part.coefficients([[6.0]])
    assert searched_model(request(), whole) is whole


def test_prior_information_is_the_inverse_covariance() -> None:
    information = prior_information(model(), known=True)
    np.testing.assert_allclose(information @ model().covariance, np.eye(6), atol=1e-12)
    with pytest.raises(MisuseError, match="covariance"):
        prior_information(model(), known=False)
