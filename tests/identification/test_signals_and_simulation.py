"""Records, frequency responses, and the simulation of models."""

import numpy as np
import pytest

from identification.errors import MisuseError, RangeError, ShapeError
from identification.lti.likelihood import residual_and_jacobian
from identification.lti.rational_fit import RationalFit
from identification.lti.rational_start import levy
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate

PLANT = RationalStructure(2, 1, 1, 1, 1, sample_time=0.5)
ZETA = np.array([-1.2, 0.5, 1.0, 0.4, 0.3, -0.6])


def test_records_are_copies_that_cannot_be_changed():
    u = np.ones(4)
    record = TimeRecord(u, [1, 2, 3, 4], 0.1, (2.0,), period=2)
    u[0] = 7
    assert record.input[0] == 1
    assert (len(record), record.period_count) == (4, 2)
    with pytest.raises(ValueError, match="read-only"):
        record.output[0] = 0


@pytest.mark.parametrize(
    ("arguments", "error", "field"),
    [
        (([1, 2], [1], 1.0), ShapeError, "output"),
        (([1], [1], 1.0), RangeError, "input"),
        (([1, np.nan], [1, 2], 1.0), RangeError, "input"),
        (([1, 2], [1, np.inf], 1.0), RangeError, "output"),
        (([1, 2], [1, 2], 0.0), RangeError, "sample_time"),
        (([1, 2], [1, 2], 1.0, (0.0,), 3), RangeError, "period"),
        (([[1, 2]], [[1, 2]], 1.0), ShapeError, "output"),
    ],
)
def test_bad_records(arguments, error, field):
    arguments = (*arguments, (0.0,)) if len(arguments) == 3 else arguments
    with pytest.raises(error) as raised:
        TimeRecord(*arguments)
    assert raised.value.field == field


@pytest.mark.parametrize(
    ("arguments", "error", "field"),
    [
        (([1.0], [1.0, 2.0], (0.0,)), ShapeError, "response"),
        (([], [], (0.0,)), ShapeError, "response"),
        (([-1.0], [1.0], (0.0,)), RangeError, "frequencies"),
        (([1.0, 1.0], [1.0, 1.0], (0.0,)), RangeError, "frequencies"),
        (([4.0], [1.0], (0.0,), 1.0), RangeError, "frequencies"),
        (([1.0], [1.0], (0.0,), -1.0), RangeError, "sample_time"),
        (([1.0], [1.0], (0.0,), None, [0.0]), RangeError, "variance"),
        (([1.0], [1.0], (0.0,), None, [1.0, 1.0]), ShapeError, "variance"),
        (([1.0], [np.nan], (0.0,)), RangeError, "response"),
    ],
)
def test_bad_responses(arguments, error, field):
    with pytest.raises(error) as raised:
        FrequencyResponse(*arguments)
    assert raised.value.field == field


def test_difference_equation_from_rest():
    u, e = np.random.default_rng(0).standard_normal((2, 50))
    a1, a2, b0, b1, c1, d1 = ZETA
    clean, noise = np.zeros(50), np.zeros(50)

    def at(x, t):
        return x[t] if t >= 0 else 0.0

    for t in range(50):
        clean[t] = -a1 * at(clean, t - 1) - a2 * at(clean, t - 2) + b0 * at(u, t - 1) + b1 * at(u, t - 2)
        noise[t] = -d1 * at(noise, t - 1) + e[t] + c1 * at(e, t - 1)
    assert np.allclose(simulate(PLANT, ZETA, u), clean)
    assert np.allclose(simulate(PLANT, ZETA, u, e), clean + noise)


def test_steady_state_is_where_many_periods_lead():
    u = np.random.default_rng(0).standard_normal(64)
    steady = simulate(PLANT, ZETA, u, periodic=True)
    assert np.allclose(steady, simulate(PLANT, ZETA, np.tile(u, 10))[-64:], atol=1e-9)


def test_continuous_time_and_delay_in_the_steady_state():
    plant = RationalStructure(1, 0, delay=True)
    t = 0.1 * np.arange(100)
    omega = 2 * np.pi / 10 * 3
    gain = plant.plant_response(np.array([2.0, 3.0, 0.25]), np.array([omega]))[0]
    assert gain == pytest.approx(3 / (1j * omega + 2) * np.exp(-0.25j * omega))
    output = simulate(plant, np.array([2.0, 3.0, 0.25]), np.cos(omega * t), sample_time=0.1, periodic=True)
    assert np.allclose(output, (gain * np.exp(1j * omega * t)).real)


def test_misuse():
    with pytest.raises(MisuseError, match="periodic"):
        simulate(RationalStructure(1, 0), np.ones(2), np.ones(10))
    with pytest.raises(MisuseError, match="sample time"):
        simulate(RationalStructure(1, 0), np.ones(2), np.ones(10), periodic=True)
    with pytest.raises(ShapeError):
        simulate(PLANT, ZETA, np.ones(10), np.ones(9))
    with pytest.raises(ShapeError):
        simulate(PLANT, ZETA[:3], np.ones(10))


def matrix_response(**changes):
    arguments = {
        "frequencies": [1.0, 2.0, 3.0],
        "response": np.arange(18.0).reshape(3, 2, 3),
        "operating_point": (0.0,),
    }
    return FrequencyResponse(**{**arguments, **changes})


def test_several_inputs_and_outputs():
    variance = 1 + np.arange(18.0).reshape(3, 2, 3)
    data = matrix_response(variance=variance)
    assert (len(data), data.output_count, data.input_count) == (3, 2, 3)
    one = data.channel(1, 2)
    assert np.array_equal(one.response, [5, 11, 17])
    assert np.array_equal(one.variance, [6, 12, 18])
    kept = data.lines(slice(None, None, 2))
    assert np.array_equal(kept.frequencies, [1.0, 3.0])
    assert np.array_equal(kept.variance, variance[::2])
    single = FrequencyResponse([1.0, 2.0], [1.0, 2.0], (0.0,), None, [1.0, 4.0])
    assert np.array_equal(single.matrices, [[[1.0]], [[2.0]]])
    assert np.array_equal(single.channel(0, 0).variance, [1.0, 4.0])


def test_a_covariance_has_the_variances_on_its_diagonal():
    g = np.random.default_rng(0)
    root = g.standard_normal((3, 6, 8)) + 1j * g.standard_normal((3, 6, 8))
    covariance = root @ root.conj().swapaxes(1, 2)
    data = matrix_response(covariance=covariance)
    assert np.allclose(data.variance[1, 1, 2], covariance[1, 5, 5].real)
    assert np.array_equal(data.lines(slice(1, 2)).covariance, covariance[1:2])
    assert np.allclose(data.channel(0, 1).variance, covariance[:, 1, 1].real)


@pytest.mark.parametrize(
    ("changes", "error", "field"),
    [
        ({"response": np.zeros((3, 2))}, ShapeError, "response"),
        ({"response": np.zeros((2, 2, 2))}, ShapeError, "response"),
        ({"response": np.zeros((3, 0, 2))}, ShapeError, "response"),
        ({"variance": np.ones(3)}, ShapeError, "variance"),
        ({"variance": np.zeros((3, 2, 3))}, RangeError, "variance"),
        ({"covariance": np.ones((3, 6))}, ShapeError, "covariance"),
        ({"covariance": -np.tile(np.eye(6), (3, 1, 1))}, RangeError, "covariance"),
        ({"covariance": np.tile(np.eye(6) + np.eye(6, k=1), (3, 1, 1))}, RangeError, "covariance"),
        ({"response": np.zeros(3), "covariance": np.ones((3, 1, 1))}, ShapeError, "covariance"),
    ],
)
def test_bad_matrix_responses(changes, error, field):
    with pytest.raises(error) as raised:
        matrix_response(**changes)
    assert raised.value.field == field


def test_methods_for_one_input_and_output_refuse_more():
    structure = RationalStructure(1, 0)
    data = matrix_response()
    for call in (
        lambda: RationalFit("absolute").estimate(structure, data),
        lambda: levy(structure, data),
        lambda: residual_and_jacobian(structure, np.ones(2), data),
    ):
        with pytest.raises(MisuseError, match="one channel at a time") as raised:
            call()
        assert raised.value.field == "response"
