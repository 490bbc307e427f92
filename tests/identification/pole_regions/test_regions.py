"""Pole regions: each inequality against the region's plain description, and the eigenvalue theorem itself."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import identification.pole_regions
from identification.errors import RangeError, ShapeError
from identification.pole_regions.cone import Cone
from identification.pole_regions.disc import Disc
from identification.pole_regions.half_plane import HalfPlane
from identification.pole_regions.intersection import Intersection
from identification.pole_regions.strip import Strip
from identification.registry import discover

REGIONS = discover(identification.pole_regions)
PLANE = np.random.default_rng(0).uniform(-3, 3, (400, 2)) @ [1, 1j]

PLAIN = [
    (Disc(1.5, 0.4), lambda z: abs(z - 0.4) < 1.5),
    (HalfPlane(0.3), lambda z: z.real < 0.3),
    (HalfPlane(-0.3, "right"), lambda z: z.real > -0.3),
    (Cone(0.6, 0.5), lambda z: abs(z.imag) < np.tan(0.6) * (0.5 - z.real)),
    (Cone(1.1, -0.5, "right"), lambda z: abs(z.imag) < np.tan(1.1) * (z.real + 0.5)),
    (Strip(0.7), lambda z: abs(z.imag) < 0.7),
    (
        Intersection((Disc(1.5), HalfPlane(0.3), Strip(0.7))),
        lambda z: (abs(z) < 1.5) & (z.real < 0.3) & (abs(z.imag) < 0.7),
    ),
]


@pytest.mark.parametrize(("region", "inside"), PLAIN, ids=lambda item: getattr(item, "kind", ""))
def test_the_inequality_is_the_region(region, inside):
    expected = inside(PLANE)
    assert expected.any()
    assert not expected.all()
    assert np.array_equal(region.contains(PLANE), expected)
    assert np.array_equal(region.contains(PLANE.conj()), expected)
    assert region.contains(PLANE.reshape(20, 20)).shape == (20, 20)


@pytest.mark.parametrize(("region", "inside"), PLAIN, ids=lambda item: getattr(item, "kind", ""))
def test_the_real_interval_is_where_it_meets_the_real_axis(region, inside):
    x = np.linspace(-2.95, 2.95, 119) + 1e-3
    lower, upper = region.real_interval
    assert np.array_equal(inside(x + 0j), (x > lower) & (x < upper))


@given(st.integers(0, 10_000), st.sampled_from([region for region, _ in PLAIN]))
@settings(max_examples=60, deadline=None)
def test_eigenvalues_inside_are_certified_by_a_matrix(seed, region):
    """A normal matrix with its eigenvalues in the region satisfies the inequality with X = I, and only then."""
    g = np.random.default_rng(seed)
    x, y = g.uniform(-3, 3), g.uniform(0, 3)
    q, _ = np.linalg.qr(g.standard_normal((2, 2)))
    a = q @ np.array([[x, y], [-y, x]]) @ q.T
    p_matrix, q_matrix = region.matrices
    value = np.kron(p_matrix, np.eye(2)) + np.kron(q_matrix, a) + np.kron(q_matrix, a).T
    assert np.isclose(np.linalg.eigvalsh(value)[-1], region.excess(x + 1j * y), atol=1e-9)


def test_the_excess_of_a_disc_is_the_distance():
    assert np.allclose(Disc(0.5, 0.2).excess(PLANE), abs(PLANE - 0.2) - 0.5)


@pytest.mark.parametrize("kind", REGIONS)
def test_examples_hold_points(kind):
    region = REGIONS[kind].example()
    region.require_points()
    assert not region.empty
    assert region == REGIONS[kind].example()
    assert all(m.shape == region.matrices[0].shape for m in region.matrices)


def test_an_empty_intersection_is_refused_with_its_numbers():
    with pytest.raises(RangeError, match=r"above 2 and below 1"):
        Intersection((Disc(1.0), HalfPlane(2.0, "right")))
    with pytest.raises(RangeError, match="empty"):
        Intersection((HalfPlane(0.0), HalfPlane(0.0, "right")))
    with pytest.raises(ShapeError):
        Intersection(())


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Disc(0.0), "radius"),
        (lambda: Disc(1.0, np.nan), "centre"),
        (lambda: HalfPlane(np.inf), "edge"),
        (lambda: HalfPlane(0.0, "up"), "side"),
        (lambda: Cone(np.pi / 2), "half_angle"),
        (lambda: Strip(-1.0), "half_height"),
    ],
)
def test_senseless_numbers_are_refused(make, field):
    with pytest.raises(RangeError) as caught:
        make()
    assert caught.value.field == field
