"""Extended models to documents."""

import dataclasses
from typing import Any

from app.arrays import finite_list_or_none
from app.conversion.effects import effect_documents
from app.conversion.models import accuracy_documents, range_documents
from app.conversion.varying_models import eigenvalue_documents, model_parts, state_space_part
from app.schemas.models import Model as ModelDocument
from identification.extension.response import coefficients
from identification.models.model import Model
from identification.models.state_space_model import joint_of_entries
from identification.outcome import Outcome


def joint_names(model: Model) -> list[str]:
    """Names of θ_G, then of the parameters of each effect, such as cubic_stiffness.e[0], resonance.frequency."""
    return [*model.parameter_names[: model.plant_size], *effect_names(model)]


def effect_names(model: Model) -> list[str]:
    """Names of the parameters of each effect."""
    names = []
    for one in model.effects:
        names += [f"{one.effect.kind}.e[{i}]" for i in range(one.size)]
        names += [f"{one.effect.kind}.{name}" for name in one.effect.fitted_names()]
    return names


def extended_affine_documents(model: Model, parent: ModelDocument) -> dict[str, Any]:
    """The same of a model from varying scheduling; fits along p(t) are not those of a model with effects."""
    joint = joint_of_entries(model)
    size = len(model.theta)
    grown = dataclasses.replace(model, covariance=None if joint is None else joint[:size, :size])
    parts = model_parts(grown, Outcome("converged"))
    assert parent.varying is not None, "a version of a model from varying scheduling"
    update: dict[str, Any] = {"steady": None, "fits": [], "warnings": [], "starting_outcome": ""}
    varying = parent.varying.model_copy(update={**update, "eigenvalues": eigenvalue_documents(grown)})
    return {
        **{name: value for name, value in parts.items() if name not in ("outcome", "tests")},
        "stateSpace": state_space_part(grown),
        "varying": varying.as_json(),
        "effects": [one.as_json() for one in effect_documents(model)],
        "jointParameterNames": [*parts["parameterNames"], *effect_names(model)],
        "jointCovariance": None if joint is None else finite_list_or_none(joint),
    }


def extended_documents(model: Model) -> dict[str, Any]:
    """What of the document of a model follows from its parameters and effects."""
    over_range = range_documents(model, lambda points: coefficients(model, points))
    return {
        "coefficientNames": list(model.structure.coefficient_names),
        "parameterNames": list(model.parameter_names),
        **_accuracy(model),
        "stable": over_range["stable"],
        "poles": [poles.as_json() for poles in over_range["poles"]],
        "effects": [one.as_json() for one in effect_documents(model)],
        "jointParameterNames": joint_names(model),
        "jointCovariance": None if model.joint_covariance is None else finite_list_or_none(model.joint_covariance),
    }


def _accuracy(model: Model) -> dict[str, Any]:
    """θ with its part of the joint covariance; that of a whole θ with a noise model is not estimated here."""
    documents = accuracy_documents(model)
    size = model.plant_size
    documents |= {"covariance": None, "standardDeviations": None}
    if model.joint_covariance is not None and size == len(model.theta):
        part = model.joint_covariance[:size, :size]
        documents["covariance"] = finite_list_or_none(part)
        documents["standardDeviations"] = [float(value) ** 0.5 for value in part.diagonal()]
    return documents
