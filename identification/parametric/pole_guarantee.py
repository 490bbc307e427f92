"""Where a matrix inequality must be imposed so that the poles lie in a region, and whether they do."""

from itertools import product

import numpy as np

from identification.arrays import FloatArray
from identification.models.model import Model
from identification.outcome import Outcome
from identification.parametric.estimate import RegionReport
from identification.pole_regions.inequality import PoleRegion
from identification.scheduling import ProductBasis, SchedulingVariable

CHECKED = 1000  # operating points of the fine grid


def corners_suffice(basis: ProductBasis, variables: tuple[SchedulingVariable, ...]) -> bool:
    """Whether sums of the functions are affine in each variable: a convex function of them then peaks at a corner."""
    for factor, variable in zip(basis.factors, variables, strict=True):
        low, high = variable.minimum, variable.maximum
        p = low + (high - low) * np.array([0.0, 0.3, 0.7, 1.0])
        values = factor.evaluate(p, low, high)
        line = values[:1] + np.array([[0.0], [0.3], [0.7], [1.0]]) * (values[3:] - values[:1])
        if not np.allclose(values, line, rtol=1e-9, atol=1e-9 * abs(values).max()):
            return False
    return True


def grid(variables: tuple[SchedulingVariable, ...], count: int) -> FloatArray:
    """`count` equidistant values of each variable in all combinations, ends included, as (count^s, s)."""
    return np.array(list(product(*(np.linspace(v.minimum, v.maximum, count) for v in variables))))


def fine_grid(variables: tuple[SchedulingVariable, ...]) -> FloatArray:
    """About a thousand operating points over the whole range."""
    return grid(variables, max(int(np.ceil(CHECKED ** (1 / len(variables)))), 2))


def worst_excess(model: Model, region: PoleRegion) -> tuple[float, FloatArray]:
    """The largest f(λ) over the fine grid, and the operating point (s,) where it is."""
    points = fine_grid(model.variables)
    excess = region.excess(model.poles(points)).max(axis=1)
    return float(excess.max()), points[int(excess.argmax())]


def stability_advice(model: Model) -> str:
    """A warning where a model without pole region is unstable somewhere in the range."""
    points = fine_grid(model.variables)
    unstable = points[~model.stable(points)]
    if not len(unstable):
        return ""
    place = ", ".join(f"{v.name} = {x:g}" for v, x in zip(model.variables, unstable[0], strict=True))
    return (
        f"the model is unstable at {len(unstable)} of {len(points)} operating points over the range (the first:"
        f" {place}); give a pole region if the plant is stable"
    )


def judged(model: Model, report: RegionReport, solved: bool, iterations: int) -> Outcome:
    """The outcome of an estimate with a pole region: infeasible when the data and the region exclude each other."""
    place = ", ".join(f"{v.name} in [{v.minimum:g}, {v.maximum:g}]" for v in model.variables)
    if report.certificate >= 0 or report.worst_excess >= 0:
        beyond = max(report.certificate, report.worst_excess)
        remedy = "take a finer grid or a larger margin" if report.where == "grid" and solved else "enlarge the region"
        return Outcome("infeasible", f"poles leave the region by up to {beyond:.3g} for {place}; {remedy}", iterations)
    cost = (
        f"without the region the relative error is {report.error_without:.3g} instead of {report.error:.3g}, and poles"
        f" leave the region by up to {report.worst_excess_without:.3g}"
    )
    if report.error > max(3 * report.error_without, report.error_without + 0.05):
        return Outcome("infeasible", f"the data do not fit into the region: {cost}; enlarge the region", iterations)
    if not solved:
        return Outcome("not_converged", f"the solver stopped early, the poles are in the region; {cost}", iterations)
    checked = (
        ""
        if report.where == "whole range"
        else (
            f"the region is imposed at {report.points} operating points and was checked on a finer grid; between them"
            " nothing is proved. "
        )
    )
    return Outcome("converged", checked + (cost if report.worst_excess_without >= 0 else ""), iterations)
