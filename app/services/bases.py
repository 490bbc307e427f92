"""The functions of a basis over the range of the scheduling variables."""

from itertools import product

import numpy as np

from app.conversion.misuse import pointing
from app.conversion.plants import parameter_dependence
from app.schemas.bases import BasisFunctionValues, BasisValues, BasisValuesRequest

MOST_POINTS = 2500
POINTERS = {"maximum": "/schedulingVariables", "basis": "/basis"}


def values(request: BasisValuesRequest) -> BasisValues:
    """The values at equidistant operating points; raises UnprocessableError for a basis that does not fit."""
    variables = request.scheduling_variables
    count = min(request.count, max(int(MOST_POINTS ** (1 / len(variables)) + 1e-9), 2))
    with pointing(POINTERS, default="/basis"):
        dependence = parameter_dependence(["f"], variables, request.basis, ())
        axes = [np.linspace(v.minimum, v.maximum, count).tolist() for v in variables]
        points = np.array(list(product(*axes)))
        found = dependence.matrix(points)[:, 0]
    functions = [
        BasisFunctionValues(label=label, values=column.tolist())
        for label, column in zip(dependence.bases[0].labels, found.T, strict=True)
    ]
    return BasisValues(axes=axes, operating_points=points.tolist(), functions=functions)
