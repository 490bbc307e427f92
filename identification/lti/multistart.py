"""The lowest of the minima that searches from several first estimates reach, without searching a valley twice."""

from collections.abc import Callable, Iterable

import numpy as np

from identification.arrays import FloatArray
from identification.least_squares import Evaluate, LeastSquaresSolution, levenberg_marquardt

FOLLOWED_PER_WAVE = 4
COARSE_ITERATIONS = 12


def lowest_minimum(
    evaluate: Evaluate,
    residual_only: Callable[[FloatArray], FloatArray],
    feasible: Callable[[FloatArray], bool],
    waves: Iterable[list[FloatArray]],
) -> LeastSquaresSolution:
    """The best solution over waves of first estimates; a wave whose estimates all lead to one minimum is the last.

    The best estimates of a wave are followed for some steps, and those that do not end in the valley of a minimum x*
    found before until they converge. A point x is taken to lie in that valley when

        ‖r(x)‖² − ‖r(x*)‖² ≈ ‖J (x − x*)‖² ≪ ‖r(x*)‖²
    """
    minima: list[LeastSquaresSolution] = []

    def known(x: FloatArray, cost: float) -> bool:
        return any(_in_valley(minimum, x, cost) for minimum in minima)

    for wave in waves:
        before = len(minima)
        coarse: list[LeastSquaresSolution] = []
        for cost, start in sorted(((_cost(residual_only, start), start) for start in wave), key=lambda pair: pair[0]):
            if len(coarse) < FOLLOWED_PER_WAVE and np.isfinite(cost) and not known(start, cost):
                coarse.append(levenberg_marquardt(evaluate, start, feasible, COARSE_ITERATIONS, 1e-4))
                if not minima:
                    minima.append(levenberg_marquardt(evaluate, coarse.pop().x, feasible, tolerance=1e-7))
        for partial in sorted(coarse, key=lambda solution: solution.cost):
            if not known(partial.x, partial.cost):
                minima.append(levenberg_marquardt(evaluate, partial.x, feasible, tolerance=1e-7))
        if len(minima) - before == 1 and minima[0].outcome.ok and not coarse:
            break
    return min(minima, key=lambda solution: solution.cost)


def _cost(residual_only: Callable[[FloatArray], FloatArray], start: FloatArray) -> float:
    residual = residual_only(start)
    return float(residual @ residual) if np.all(np.isfinite(residual)) else np.inf


def _in_valley(best: LeastSquaresSolution, start: FloatArray, cost: float) -> bool:
    expected = float(np.sum((best.jacobian @ (start - best.x)) ** 2))
    excess = cost - best.cost
    return (
        expected <= 0.2 * best.cost
        and 0.3 * expected <= excess + 1e-7 * best.cost
        and excess <= 3 * expected + 1e-7 * best.cost
    )
