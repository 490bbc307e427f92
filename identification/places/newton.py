"""Fixed points that mixing of steps does not reach."""

from typing import Any

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.simulate import NoSteadyStateError, Update, fixed_point

TOLERANCE = 1e-9
ITERATIONS, INNER = 30, 100


def newton(update: Update, start: ComplexArray, limit: int) -> ComplexArray:
    """X = update(X) (M, K) by `fixed_point`, and where that gives up by Newton's method on X − update(X) = 0.

    Each step is solved by Krylov iteration on differences of `update` and shortened until it leads down, to
    ‖X − update(X)‖ ≤ 10⁻⁹ ‖start‖. Raises NoSteadyStateError when that is not reached either.
    """
    try:
        return fixed_point(update, start, limit)
    except NoSteadyStateError as error:
        found = _solved(update, start)
        if found is None:
            raise error
        return found


def _solved(update: Update, start: ComplexArray) -> ComplexArray | None:
    from scipy.optimize import NoConvergence, newton_krylov

    half = start.size

    def complex_of(parts: FloatArray) -> ComplexArray:
        return np.asarray((parts[:half] + 1j * parts[half:]).reshape(start.shape))

    def parts_of(lines: ComplexArray) -> FloatArray:
        return np.concatenate([lines.real.ravel(), lines.imag.ravel()])

    def remainder(parts: FloatArray) -> FloatArray:
        return parts - parts_of(update(complex_of(parts)))

    solver: Any = newton_krylov
    options = {
        "f_tol": TOLERANCE * np.linalg.norm(start),
        "tol_norm": np.linalg.norm,
        "maxiter": ITERATIONS,
        "inner_maxiter": INNER,
    }
    try:
        with np.errstate(all="ignore"):
            return complex_of(solver(remainder, parts_of(start), method="gmres", **options))
    except (NoConvergence, ValueError, FloatingPointError, np.linalg.LinAlgError):
        return None
