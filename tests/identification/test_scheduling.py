"""Scheduling variables, basis functions and T(p)."""

import numpy as np
import pytest

from identification.bases.b_spline import BSpline
from identification.bases.chebyshev import Chebyshev
from identification.bases.polynomial import Polynomial
from identification.errors import RangeError, ShapeError, TooFewOperatingPointsError
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

P = SchedulingVariable("p", "V", 0.0, 8.0)
TEMPERATURE = SchedulingVariable("temperature", "K", 250.0, 350.0)


def test_the_matrix_of_the_example():
    basis = ProductBasis((Polynomial(1),))
    dependence = ParameterDependence((P,), (basis, basis, ProductBasis((Polynomial(0),))))
    assert np.array_equal(dependence.matrix([[3.0]])[0], [[1, 3, 0, 0, 0], [0, 0, 1, 3, 0], [0, 0, 0, 0, 1]])
    assert (dependence.size, dependence.sizes) == (5, (2, 2, 1))
    assert dependence.parameter_names(["a", "b", "c"]) == ("a[0]", "a[1]", "b[0]", "b[1]", "c[0]")


def test_products_in_full_and_by_total_degree():
    factors = (Polynomial(2), Polynomial(1))
    variables = (P, TEMPERATURE)
    point = np.array([[2.0, 300.0]])
    full = ProductBasis(factors)
    assert full.labels == ("0,0", "0,1", "1,0", "1,1", "2,0", "2,1")
    assert np.array_equal(full.evaluate(point, variables)[0], [1, 300, 2, 600, 4, 1200])
    limited = ProductBasis(factors, total_degree=2)
    assert limited.labels == ("0,0", "0,1", "1,0", "1,1", "2,0")
    assert np.array_equal(limited.evaluate(point, variables)[0], [1, 300, 2, 600, 4])


def test_values_of_the_bases():
    p = np.array([2.0, 3.0, 4.0])
    assert np.array_equal(Polynomial(2).evaluate(p, 2, 4), [[1, 2, 4], [1, 3, 9], [1, 4, 16]])
    assert np.allclose(Chebyshev(3).evaluate(p, 2, 4), [[1, -1, 1, -1], [1, 0, -1, 0], [1, 1, 1, 1]])
    splines = BSpline(1, (3.0,)).evaluate(p, 2, 4)
    assert np.allclose(splines, np.eye(3))
    assert np.allclose(BSpline(3, (2.5, 3.5)).evaluate(np.linspace(2, 4, 20), 2, 4).sum(axis=1), 1)


def test_powers_of_an_integer_point():
    assert Polynomial(1).evaluate(np.array([0.0]), 0, 1).tolist() == [[1.0, 0.0]]


def test_bad_bases():
    for make in (lambda: Polynomial(-1), lambda: Chebyshev(-1), lambda: BSpline(-1), lambda: BSpline(1, (2.0, 1.0))):
        with pytest.raises(RangeError):
            make()
    with pytest.raises(RangeError, match="inside"):
        BSpline(1, (9.0,)).evaluate(np.array([1.0]), 0, 8)


def test_bad_variables_and_points():
    with pytest.raises(RangeError):
        SchedulingVariable("p", "", 1.0, 1.0)
    with pytest.raises(RangeError):
        SchedulingVariable("p", "", 0.0, np.inf)
    dependence = ParameterDependence((P,), (ProductBasis((Polynomial(1),)),))
    with pytest.raises(ShapeError):
        dependence.matrix([[1.0, 2.0]])
    with pytest.raises(ShapeError):
        dependence.matrix([1.0])
    with pytest.raises(RangeError, match="outside its range"):
        dependence.matrix([[8.1]])
    with pytest.raises(RangeError, match="finite"):
        dependence.matrix([[np.nan]])
    with pytest.raises(ShapeError, match="one factor per variable"):
        ParameterDependence((P, TEMPERATURE), (ProductBasis((Polynomial(1),)),))


def test_how_many_points_are_needed():
    quadratic = ProductBasis((Polynomial(2),))
    dependence = ParameterDependence((P,), (ProductBasis((Polynomial(1),)), quadratic))
    dependence.require_identifiable([[0.0], [4.0], [8.0]])
    with pytest.raises(TooFewOperatingPointsError) as raised:
        dependence.require_identifiable([[0.0], [4.0], [4.0]])
    assert (raised.value.needed, raised.value.given) == (3, 2)
    tensor = ParameterDependence((P, TEMPERATURE), (ProductBasis((Polynomial(1), Polynomial(1))),))
    with pytest.raises(TooFewOperatingPointsError, match="placed"):
        tensor.require_identifiable([[0.0, 250.0], [2.0, 275.0], [4.0, 300.0], [6.0, 325.0]])
    tensor.require_identifiable([[0.0, 250.0], [0.0, 350.0], [8.0, 250.0], [8.0, 350.0]])


def test_groups_give_what_the_matrix_gives() -> None:
    """Two matrices of four and two entries, θ by group, function and entry, against T(p) written out."""
    variables = (SchedulingVariable("v", "", 0.0, 1.0),)
    bases = (ProductBasis((Polynomial(1),)), ProductBasis((Polynomial(0),)))
    dependence = ParameterDependence(variables, bases, entries=(4, 2))
    theta, p = np.arange(10.0), 0.3
    assert dependence.size == 10
    assert np.allclose(dependence.coefficients(theta, [[p]])[0], [*(theta[:4] + p * theta[4:8]), 8.0, 9.0])
    transfer = np.block([[np.eye(4), p * np.eye(4), np.zeros((4, 2))], [np.zeros((2, 8)), np.eye(2)]])
    assert np.allclose(dependence.matrix([[p]])[0], transfer)
    gradient = np.random.default_rng(0).standard_normal((1, 3, 5, 6)) * (1 + 2j)
    assert np.allclose(dependence.pulled(gradient, [[p]]), gradient @ transfer)
    assert np.allclose(dependence.pulled(gradient[..., :4], [[p]]), gradient[..., :4] @ transfer[:4, :8])
    names = dependence.parameter_names([*"abcdef"])
    assert names[4:9:2] == ("a[1]", "c[1]", "e[0]")
    with pytest.raises(ShapeError):
        ParameterDependence(variables, bases, entries=(4,))
