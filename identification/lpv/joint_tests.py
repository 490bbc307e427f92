"""Tests of a model that all experiments share."""

import numpy as np

from identification.arrays import FloatArray
from identification.least_squares import LeastSquaresSolution
from identification.lpv.joint_residuals import JointResiduals
from identification.lpv.stacking import place
from identification.lti.free_noise import with_nuisance
from identification.lti.response_tests import gaussian_errors, real_count
from identification.lti.whiteness import chi_square, input_independence, orthonormal, whiteness
from identification.outcome import TestResult
from identification.signals import FrequencyResponse, TimeRecord


def joint_tests(residuals: JointResiduals, solution: LeastSquaresSolution) -> tuple[TestResult, ...]:
    """Whether ζ(p) = T(p) θ holds at all operating points, and for each experiment whether its residual is noise.

        Σ_m ‖Q_mᵀ r_m‖² ~ χ²(Σ_m rank J_m − k),   Q_m an orthonormal basis of what ∂r_m/∂ζ spans

    is the score form of the test of S (ζ̂ − 𝒯 θ̂) [Ghosh2018, Remark 3]: it asks whether a ζ_m of its own would fit an
    experiment better than T(p_m) θ̂. Records are tested for whiteness and for independence of the past input, frequency
    responses of known variance by ‖r_m‖² ~ χ²(2F − tr H_m), H_m the block of the hat matrix.
    """
    if not np.all(np.isfinite(solution.covariance)):
        return ()
    overall, ranks = 0.0, 0
    each: list[TestResult | None] = []
    leverage = residuals.leverage(solution)
    for m, (data, part) in enumerate(zip(residuals.experiments, residuals.parts(), strict=True)):
        jacobian = residuals.local(m, solution.x)[1]
        residual = solution.residual[part]
        basis = orthonormal(jacobian)
        overall += float(np.sum((basis.T @ residual) ** 2))
        ranks += basis.shape[1]
        where = place(data.operating_point)
        if isinstance(data, TimeRecord):
            zeta = residuals.transfer[m] @ solution.x
            covariance = residuals.transfer[m] @ solution.covariance @ residuals.transfer[m].T
            structure = residuals.structure_of_records
            beside, taken = with_nuisance(structure, zeta, data, jacobian)
            each.append(_at(where, whiteness(structure, zeta, covariance, residual, taken=taken)))
            each.append(_at(where, input_independence(structure, residual, beside, data.input)))
        elif data.variance is not None:
            each.append(_fit_of_response(where, data, residuals.local(m, solution.x)[0], float(leverage[part].sum())))
    freedom = ranks - len(solution.x) + (0 if residuals.prior is None else len(solution.x))
    if residuals.prior is not None:
        overall += float(np.sum(solution.residual[residuals.parts()[-1].stop :] ** 2))
    name = "dependence on the operating point"
    first = chi_square(name, overall, freedom) if freedom > 0 else TestResult(name, 0.0, 0.0, 1.0)
    return (first, *(test for test in each if test is not None))


def _fit_of_response(where: str, data: FrequencyResponse, residual: FloatArray, used: float) -> TestResult | None:
    freedom = real_count(data) - used
    if freedom < 0.5:
        return None
    errors = (residual[: len(data)] + 1j * residual[len(data) :]) / np.sqrt(2)
    statistic = 2 * float(np.sum(abs(gaussian_errors(data, errors)) ** 2))
    return chi_square(f"lack of fit, {where}", statistic, freedom)


def _at(where: str, test: TestResult | None) -> TestResult | None:
    if test is None:
        return None
    return TestResult(f"{test.name}, {where}", test.statistic, test.degrees_of_freedom, test.p_value)
