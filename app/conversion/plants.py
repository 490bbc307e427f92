"""Plants and models: documents to structures, dependences and parameter-varying models."""

from collections.abc import Sequence

import numpy as np
from typing_extensions import TypeIs

from app.schemas.plants import (
    CoefficientBasis,
    DiscreteStateSpaceStructure,
    PlantRequest,
    ProductBasisDocument,
    SchedulingVariableDocument,
    StateSpaceStructure,
    StateSpaceStructureDocument,
    Structure,
)
from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.model import Model
from identification.models.physical import RationalForm
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

MAX_PARAMETERS = 200
MAX_BASIS_SIZE = 100
MAX_MATRIX_ENTRIES = 20_000
MATRIX_NAMES = ("A", "B", "C", "D")


def is_state_space(document: Structure) -> TypeIs[StateSpaceStructureDocument]:
    """Whether a structure is one of state-space models."""
    return isinstance(document, StateSpaceStructure)


def rational_of(document: Structure) -> RationalForm:
    """The rational structure of a document; raises MisuseError when it is of another kind."""
    if is_state_space(document):
        raise MisuseError("the structure is that of state-space models; this needs a rational one", "structure")
    return document.structure()


def product_basis(document: ProductBasisDocument) -> ProductBasis:
    """The basis of a document; raises RangeError when it is empty or too large."""
    factors = tuple(factor.build() for factor in document.factors)
    if np.prod([float(factor.size) for factor in factors]) > 100 * MAX_BASIS_SIZE:
        raise RangeError(f"the basis has more than {MAX_BASIS_SIZE} functions; choose lower degrees", "basis")
    basis = ProductBasis(factors, document.total_degree)
    if basis.size > MAX_BASIS_SIZE:
        raise RangeError(f"the basis has {basis.size} functions, at most {MAX_BASIS_SIZE} are allowed", "basis")
    return basis


def parameter_dependence(
    names: Sequence[str],
    variables: Sequence[SchedulingVariableDocument],
    basis: ProductBasisDocument,
    exceptions: Sequence[CoefficientBasis],
) -> ParameterDependence:
    """How the coefficients (or matrices) of these names depend on the scheduling variables.

    Raises RangeError for a coefficient that is not among them or that is named twice, and for too many
    parameters; ShapeError when a basis has not one factor for each variable.
    """
    own = {item.coefficient: product_basis(item.basis) for item in exceptions}
    unknown = sorted(set(own) - set(names))
    if unknown or len(own) < len(exceptions):
        raise RangeError(
            f"each coefficient is named once, and is one of {', '.join(names)}"
            + (f"; {unknown[0]} is not" if unknown else ""),
            "coefficient_bases",
        )
    common = product_basis(basis)
    dependence = ParameterDependence(
        tuple(SchedulingVariable(v.name, v.unit, v.minimum, v.maximum) for v in variables),
        tuple(own.get(name, common) for name in names),
    )
    if dependence.size > MAX_PARAMETERS:
        raise RangeError(f"the model has {dependence.size} parameters, at most {MAX_PARAMETERS} are allowed", "basis")
    _evaluate_at_both_ends(dependence)
    return dependence


def _evaluate_at_both_ends(dependence: ParameterDependence) -> None:
    """Bases check their knots against the range when they are evaluated."""
    ends = [[v.minimum for v in dependence.variables], [v.maximum for v in dependence.variables]]
    if not np.isfinite(dependence.matrix(ends)).all():
        raise RangeError("a basis function overflows inside the range; choose a lower degree or another unit", "basis")


def structure_and_dependence(plant: PlantRequest) -> tuple[RationalForm, ParameterDependence]:
    """The rational structure of a plant and how it depends on the scheduling variables; raises MisuseError."""
    structure = rational_of(plant.structure)
    return structure, plant_dependence(plant)


def plant_dependence(plant: PlantRequest) -> ParameterDependence:
    """How the coefficients of a plant, or the matrices of its models in state space, depend on the variables."""
    names = [variable.name for variable in plant.scheduling_variables]
    if len(set(names)) < len(names):
        raise RangeError("two scheduling variables have the same name", "scheduling_variables")
    if is_state_space(plant.structure):
        return state_space_dependence(plant, plant.structure, plant.basis, plant.coefficient_bases)
    coefficients = rational_of(plant.structure).coefficient_names
    return parameter_dependence(coefficients, plant.scheduling_variables, plant.basis, plant.coefficient_bases)


def state_space_dependence(
    plant: PlantRequest,
    structure: StateSpaceStructureDocument,
    basis: ProductBasisDocument,
    exceptions: Sequence[CoefficientBasis],
) -> ParameterDependence:
    """How the matrices of state-space models depend on the scheduling variables.

    Raises RangeError as `parameter_dependence` does, and for matrices with too many entries.
    """
    dependence = parameter_dependence(MATRIX_NAMES, plant.scheduling_variables, basis, exceptions)
    (n_y, n_u), n = channels(plant), structure.order or 1
    entries = int(np.dot(dependence.sizes, (n * n, n * n_u, n_y * n, n_y * n_u)))
    if entries > MAX_MATRIX_ENTRIES:
        raise RangeError(
            f"the matrices have {entries} entries, at most {MAX_MATRIX_ENTRIES} are allowed; choose a lower order or a"
            " smaller basis",
            "basis",
        )
    return dependence


def scheduling_variables(plant: PlantRequest) -> tuple[SchedulingVariable, ...]:
    """The scheduling variables with their ranges."""
    return tuple(SchedulingVariable(v.name, v.unit, v.minimum, v.maximum) for v in plant.scheduling_variables)


def channels(plant: PlantRequest) -> tuple[int, int]:
    """Number of outputs and of inputs."""
    return len(plant.outputs or (plant.output,)), len(plant.inputs or (plant.input,))


def sample_time(structure: StateSpaceStructureDocument) -> float | None:
    """In seconds; None in continuous time."""
    return structure.sample_time_seconds if isinstance(structure, DiscreteStateSpaceStructure) else None


def lpv_model(
    structure: RationalForm,
    dependence: ParameterDependence,
    theta: Sequence[float],
    covariance: Sequence[Sequence[float]] | None,
    noise_variance: float,
) -> Model:
    """The model of given parameters; without a covariance it is taken as exactly known (zero covariance)."""
    k = dependence.size
    if covariance is None:
        matrix = np.zeros((k, k))
    elif len({len(row) for row in covariance}) > 1:
        raise ShapeError("the rows of the covariance differ in length", "covariance")
    else:
        matrix = np.array(covariance, dtype=float)
    return Model(structure, dependence, np.array(theta, dtype=float), matrix, noise_variance)
