"""The one verb: from data to a model with covariance."""

from collections.abc import Sequence
from typing import Literal

from identification import methods
from identification.errors import MisuseError
from identification.estimates import Estimate
from identification.methods.method import Data, Method, Task
from identification.models.model import Model
from identification.models.structure import Structure
from identification.registry import discover
from identification.scheduling import ParameterDependence, ProductBasis
from identification.varying.progress import Progress, silent


def identify(
    data: Data | Sequence[Data],
    structure: Structure,
    dependence: ParameterDependence | None = None,
    method: Method | Literal["automatic"] = "automatic",
    *,
    start: Model | None = None,
    prior: Model | None = None,
    progress: Progress = silent,
) -> Estimate:
    """The model of a structure that data speak for, with its covariance and how far it may be believed.

    `data`: one measurement or several, held still at operating points or along p(t). `dependence`: how coefficients
    depend on the scheduling variables, see `Structure.over`; without it they are constants, and operating points are
    empty. `method`: "automatic" chooses by data and structure, see `chosen`. `prior`: an estimate of the same structure
    and dependence from other data, whose information is added. Raises MisuseError, whose `field` names the argument.
    """
    given = (data,) if isinstance(data, Data) else tuple(data)
    if not given:
        raise MisuseError("no data were given; give at least one measurement", "data")
    how = structure.over((), ProductBasis(())) if dependence is None else dependence
    if how.coefficient_count != structure.size:
        raise MisuseError(
            f"the dependence is one of {how.coefficient_count} coefficients and the structure has {structure.size};"
            " make it by structure.over(variables, basis)",
            "dependence",
        )
    task = Task(given, structure, how, start, prior)
    used = chosen(task) if method == "automatic" else method
    used.check(task)
    return used.estimate(task, progress)


def chosen(task: Task) -> Method:
    """The usual method for data and structure.

    Rational structures: local models, then maximum likelihood over all data, in discrete time by prediction errors,
    else by frequency responses. State spaces: by likelihood from responses, or along p(t) from a record of that.
    """
    suitable = [method for method in discover(methods).values() if method.takes.has(task)]
    if not suitable:
        takes = "; ".join(f"{kind} {method.takes}" for kind, method in discover(methods).items())
        raise MisuseError(f"no method takes such data for a {type(task.structure).__name__}: {takes}", "data")
    found: Method = suitable[0].usual(task)
    return found
