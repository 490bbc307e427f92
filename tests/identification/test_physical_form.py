"""Physical coefficients: what is linear in p in physics is linear in the model, with a covariance that holds."""

import numpy as np
import pytest
from scipy import integrate, stats

from identification import identify
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, RangeError, ShapeError
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.rational_fit import RationalFit
from identification.models.physical import Coefficient, PhysicalForm
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse, HeldInput, TimeRecord

LOAD = SchedulingVariable("load", "kg", 0.0, 1.0)
MOTOR = PhysicalForm(
    (Coefficient("J", "kg m2"), Coefficient("d", "N m s")), (Coefficient("k", "N m/A", fixed=0.5),), frequency_scale=5.0
)
THETA = np.array([0.02, 0.05, 0.1])  # J = 0.02 + 0.05 p, d = 0.1
DEPENDENCE = ParameterDependence((LOAD,), (ProductBasis((Polynomial(1),)), ProductBasis((Polynomial(0),))))
OMEGA = np.geomspace(0.3, 60, 40)
POINTS = np.linspace(0, 1, 6)
SECOND = PhysicalForm(
    (Coefficient("m", fixed=2.0), Coefficient("c"), Coefficient("k")),
    (Coefficient("b1"), Coefficient("b0")),
    30.0,
    True,
)
SECOND_ZETA = np.array([3.0, 800.0, 0.7, 20.0, 0.01])


def motor_response(p: float, omega: np.ndarray) -> np.ndarray:
    return 0.5 / ((0.02 + 0.05 * p) * 1j * omega + 0.1)


def measured(generator: np.random.Generator | None = None, relative: float = 0.01) -> list[FrequencyResponse]:
    found = []
    for p in POINTS:
        true = motor_response(p, OMEGA)
        variance = (relative * abs(true)) ** 2
        noise = 0.0
        if generator is not None:
            parts = generator.standard_normal((2, len(OMEGA)))
            noise = np.sqrt(variance / 2) * (parts[0] + 1j * parts[1])
        found.append(FrequencyResponse(OMEGA, true + noise, (float(p),), variance=variance))
    return found


def identified(data: list[FrequencyResponse], structure=MOTOR, dependence=DEPENDENCE):
    return identify(data, structure, dependence)


def test_a_motor_with_linear_inertia_is_exact_without_noise():
    model = identified(measured()).model
    assert model.theta == pytest.approx(THETA, rel=1e-8)
    assert len(model.parameter_names) == 3


def test_the_leading_one_form_of_degree_two_lacks_fit_where_the_physical_form_does_not():
    data = measured(np.random.default_rng(0), 0.003)
    leading = RationalStructure(1, 0, frequency_scale=5.0)
    quadratic = ParameterDependence((LOAD,), (ProductBasis((Polynomial(2),)),) * 2)
    wrong = identified(data, leading, quadratic).tests[0]
    right = identified(data).tests[0]
    assert wrong.p_value < 1e-6
    assert right.p_value > 1e-3


@pytest.mark.parametrize("joint", [True, False])
def test_the_covariance_holds(joint):
    g = np.random.default_rng(1)
    distances = []
    for _ in range(60):
        data = measured(g)
        local = [RationalFit().estimate(MOTOR, one) for one in data]
        method = JointLikelihood() if joint else GeneralisedLeastSquares()
        model = method.estimate(MOTOR, DEPENDENCE, data, local).model
        distances.append((model.theta - THETA) @ np.linalg.solve(model.covariance, model.theta - THETA))
    assert stats.kstest(distances, stats.chi2(3).cdf).pvalue > 1e-3


def test_no_local_model_is_needed():
    """Two frequencies a point do for a start from all experiments together."""
    data = [
        FrequencyResponse(
            one.frequencies[[5, 30]], one.response[[5, 30]], one.operating_point, variance=one.variance[[5, 30]]
        )
        for one in measured()
    ]
    model = JointLikelihood().estimate(MOTOR, DEPENDENCE, data).model
    assert model.theta == pytest.approx(THETA, rel=1e-7)


def test_the_response_is_that_of_the_differential_equation():
    """2 ÿ + 3 ẏ + 800 y = 0.7 u̇ + 20 u, integrated with u = cos ωt until it is steady."""
    omega, (c, k, b1, b0, tau) = 17.0, SECOND_ZETA
    end = 90 * 2 * np.pi / omega

    def slope(t, state):
        u, du = np.cos(omega * t), -omega * np.sin(omega * t)
        return [state[1], (b1 * du + b0 * u - c * state[1] - k * state[0]) / 2.0]

    t = np.linspace(end - 2 * np.pi / omega, end, 801)[:-1]
    y = integrate.solve_ivp(slope, (0, end), [0, 0], t_eval=t, rtol=1e-10, atol=1e-13).y[0]
    line = 2 * np.mean(y * np.exp(-1j * omega * t))
    found = SECOND.plant_response(SECOND_ZETA, np.array([omega]))[0]
    assert found == pytest.approx(line * np.exp(-1j * omega * tau), rel=1e-5)


@pytest.mark.parametrize("held", [None, HeldInput(0.02, "zero")])
def test_gradients_agree_with_differences(held):
    omega = np.array([0.5, 5.0, 19.0, 40.0])
    gradient = SECOND.plant_gradient(SECOND_ZETA, omega, held)
    poles, slopes = SECOND.pole_gradient(SECOND_ZETA)
    assert 2 * poles**2 + 3 * poles + 800 == pytest.approx(0, abs=1e-9)
    for i, value in enumerate(SECOND_ZETA):
        step = np.zeros(5)
        step[i] = 1e-6 * abs(value)
        up, down = (SECOND.plant_response(SECOND_ZETA + s * step, omega, held) for s in (1, -1))
        assert (up - down) / (2 * step[i]) == pytest.approx(gradient[i], rel=1e-5, abs=1e-9 * abs(gradient[i]).max())
        moved = np.sort_complex(SECOND.poles(SECOND_ZETA + step)) - np.sort_complex(SECOND.poles(SECOND_ZETA - step))
        order = np.argsort(poles)
        assert moved / (2 * step[i]) == pytest.approx(slopes[order, i], rel=1e-4, abs=1e-8)


def test_there_and_back():
    plain = SECOND.to_plain(SECOND_ZETA)
    assert SECOND.of_plain(plain) == pytest.approx(SECOND_ZETA, rel=1e-12)
    assert SECOND.plain.plant_response(plain, OMEGA) == pytest.approx(SECOND.plant_response(SECOND_ZETA, OMEGA))
    a_0, a, b_0, b = SECOND.affine(OMEGA)
    ratio = (b_0 + SECOND_ZETA[:4] @ b) / (a_0 + SECOND_ZETA[:4] @ a)
    assert ratio * np.exp(-0.01j * OMEGA) == pytest.approx(SECOND.plant_response(SECOND_ZETA, OMEGA), rel=1e-12)


def test_what_is_refused():
    free = Coefficient("J"), Coefficient("d")
    with pytest.raises(RangeError, match="exactly one"):
        PhysicalForm(free, (Coefficient("k"),))
    with pytest.raises(RangeError, match="other than zero"):
        PhysicalForm(free, (Coefficient("k", fixed=0.0),))
    with pytest.raises(RangeError, match="name of its own"):
        PhysicalForm(free, (Coefficient("J", fixed=1.0),))
    with pytest.raises(ShapeError, match="coefficient each"):
        PhysicalForm((), (Coefficient("k", fixed=1.0),))
    with pytest.raises(MisuseError, match="discrete time"):
        MOTOR.along(np.zeros((3, 2)), np.zeros((3, 1)))
    with pytest.raises(MisuseError, match="frequency response"):
        JointLikelihood().estimate(
            MOTOR, DEPENDENCE, [TimeRecord(np.arange(9.0), np.arange(9.0), 0.1, (p,)) for p in (0.0, 1.0)]
        )
