"""Functions of the scheduling as signals: any basis, the way back to it, and what cannot be told apart."""

import numpy as np
import pytest

from identification.arrays import FloatArray
from identification.bases.b_spline import BSpline
from identification.bases.chebyshev import Chebyshev
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, NotIdentifiableError, ShapeError
from identification.methods.identify import identify
from identification.models.model import Model
from identification.models.state_space import StateSpaceStructure
from identification.scheduling import ProductBasis, SchedulingVariable
from identification.varying.records import VaryingRecord
from identification.varying.scheduled import Scheduled
from tests.identification.varying.models import output_along

STRUCTURE = StateSpaceStructure(2, 1, 1, 1.0)
QUADRATIC = [Polynomial(2), Chebyshev(2), BSpline(2), BSpline(2, (0.25,))]


def plant(u: FloatArray, q: FloatArray) -> FloatArray:
    """Two states, every matrix with q and q², one sample after the other."""
    x, y = np.zeros(2), np.empty(len(u))
    for t, s in enumerate(q):
        v = u[t, 0]
        y[t] = x[0] + (0.3 * s * s - 0.1 * s) * x[1] + 0.2 * s * s * v
        first = (0.5 + 0.2 * s * s) * x[0] + 0.3 * x[1] + v
        second = -0.2 * x[0] + (0.4 - 0.25 * s * s + 0.05 * s) * x[1] + (0.5 - 0.4 * s * s) * v
        x = np.array([first, second])
    return y[:, None]


def signals(seed: int, period: int | None, samples: int = 1500) -> tuple[FloatArray, FloatArray]:
    """u and q in −1 … 1, white, or with a period of q that is a twentieth of theirs."""
    g = np.random.default_rng(seed)
    if period is None:
        return g.standard_normal((samples, 1)), g.uniform(-1, 1, samples)
    repeats = samples // period
    return np.tile(g.standard_normal((period, 1)), (repeats, 1)), np.tile(g.uniform(-1, 1, 12), samples // 12)


def described(q: FloatArray, ends: tuple[float, float]) -> FloatArray:
    """The scheduling variable (N, 1) that runs over its range as q does over −1 … 1."""
    return (ends[0] + (q + 1) / 2 * (ends[1] - ends[0]))[:, None]


def identified(basis: ProductBasis, record: VaryingRecord) -> Model:
    found = identify(record, STRUCTURE, STRUCTURE.over(record.variables, basis))
    assert found.outcome.ok
    return found.model


@pytest.mark.parametrize("ends", [(-1.0, 1.0), (0.0, 1.0), (5.0, 10.0)])
@pytest.mark.parametrize("period", [None, 240])
def test_a_plant_with_squares_comes_back_exactly(period: int | None, ends: tuple[float, float]) -> None:
    u, q = signals(1, period, 1440)
    variables = (SchedulingVariable("p", "", *ends),)
    fresh, other = np.random.default_rng(2).standard_normal((400, 1)), np.random.default_rng(3).uniform(-1, 1, 400)
    truth = plant(fresh, other)
    for basis in QUADRATIC[:3]:
        record = VaryingRecord(u, plant(u, q), described(q, ends), 1.0, period, variables)
        model = identified(ProductBasis((basis,)), record)
        error = output_along(model, fresh, described(other, ends)) - truth
        assert np.linalg.norm(error) < 1e-8 * np.linalg.norm(truth), basis


def test_an_affine_model_of_it_is_seen_to_lack_something() -> None:
    u, q = signals(4, 240, 1440)
    g = np.random.default_rng(5)
    y = plant(u, q) + 0.01 * g.standard_normal((len(u), 1))
    record = VaryingRecord(u, y, q[:, None], 1.0, 240, (SchedulingVariable("p", "", -1.0, 1.0),))
    fits = [identify(record, STRUCTURE, STRUCTURE.over(record.variables, ProductBasis((b,)))) for b in QUADRATIC]
    assert all(found.tests[0].p_value > 1e-3 for found in fits)
    affine = identify(record, STRUCTURE, STRUCTURE.over(record.variables, ProductBasis((Polynomial(1),))))
    assert affine.tests[0].p_value < 1e-9
    assert "fits worse than the noise allows" in affine.outcome.advice


@pytest.mark.parametrize("period", [None, 240])
@pytest.mark.parametrize("basis", [Polynomial(2), BSpline(2)])
def test_the_covariance_is_that_over_runs(period: int | None, basis: Polynomial | BSpline) -> None:
    """Frozen responses between the runs' own points: mean of the squared errors over their stated variances."""
    u, q = signals(6, period, 960)
    clean, ends = plant(u, q), (2.0, 4.0)
    variables, point, omega = (SchedulingVariable("p", "", *ends),), np.array([[2.7]]), np.array([0.3, 1.2])
    s = (2.7 - 3.0) / 1.0
    a = np.array([[0.5 + 0.2 * s * s, 0.3], [-0.2, 0.4 - 0.25 * s * s + 0.05 * s]])
    b, c = np.array([1.0, 0.5 - 0.4 * s * s]), np.array([1.0, 0.3 * s * s - 0.1 * s])
    exact = np.array([c @ np.linalg.solve(np.exp(1j * w) * np.eye(2) - a, b) + 0.2 * s * s for w in omega])
    distances = []
    for seed in range(24):
        noise = 0.05 * np.random.default_rng(100 + seed).standard_normal((len(u), 1))
        record = VaryingRecord(u, clean + noise, described(q, ends), 1.0, period, variables)
        model = identified(ProductBasis((basis,)), record)
        error = model.frequency_response(point, omega)[0, :, 0, 0] - exact
        parts = np.stack([error.real, error.imag], axis=-1)
        known = np.linalg.inv(model.response_covariance(point, omega)[0, :, 0, 0])
        distances.append(np.einsum("fi,fij,fj->f", parts, known, parts))
    assert np.mean(distances) == pytest.approx(2.0, abs=4 * 2 / np.sqrt(24))
    assert np.mean(distances) < 3.2


def test_the_way_to_the_functions_and_back() -> None:
    u, q = signals(7, None, 300)
    variables = (SchedulingVariable("p", "", 5.0, 10.0),)
    record = VaryingRecord(u, plant(u, q), described(q, (5.0, 10.0)), 1.0, None, variables)
    basis = ProductBasis((BSpline(2, (7.0,)),))
    scheduled = Scheduled.of(record, basis)
    phi = scheduled.signals.phi
    assert np.allclose(phi[:, 0], 1)
    assert np.allclose(phi.T @ phi / len(phi), np.eye(4), atol=1e-9)
    g = np.random.default_rng(8)
    stacks = tuple(g.standard_normal((4, *shape)) for shape in STRUCTURE.shapes)
    model = scheduled.model(stacks)
    assert all(np.allclose(one, other) for one, other in zip(scheduled.matrices(model, 2), stacks, strict=True))
    along = STRUCTURE.matrices(model.coefficients(record.scheduling))[0]
    assert np.allclose(along, np.einsum("ti,iab->tab", phi, stacks[0]))


def test_what_cannot_be_told_apart_or_does_not_fit_is_said() -> None:
    u, q = signals(9, None, 300)
    variables = (SchedulingVariable("p", "", -1.0, 1.0),)
    two = VaryingRecord(u, u, np.where(q > 0, 1.0, -1.0), 1.0, None, variables)
    with pytest.raises(NotIdentifiableError, match="tell the 3 basis functions apart"):
        Scheduled.of(two, ProductBasis((Polynomial(2),)))
    both = VaryingRecord(u, u, np.column_stack([q, q**3]), 1.0, None, (*variables, SchedulingVariable("r", "", -1, 1)))
    with pytest.raises(MisuseError, match="constant along this record"):
        Scheduled.of(both, ProductBasis((BSpline(1), BSpline(1)), total_degree=1))
    with pytest.raises(ShapeError, match="one factor for each"):
        Scheduled.of(both, ProductBasis((Polynomial(1),)))
    with pytest.raises(MisuseError, match="declare the scheduling variables"):
        Scheduled.of(VaryingRecord(u, u, q, 1.0), ProductBasis((BSpline(2),)))
