"""New versions of models to documents."""

from typing import Any

from app import __version__
from app.conversion.extensions import extended_affine_documents, extended_documents
from app.conversion.models import outcome_document
from app.schemas.models import ExtensionReport, Model
from identification.extension.fit import Fit

INHERITED = ("structure", "basis", "coefficientBases", "localEstimator", "lpvEstimator", "spectralEstimator")
ASKED = ("name", "description", "seed", "experimentIds")


def version_document(
    parent: Model, parent_id: str, grown: Fit, asked: dict[str, Any], report: ExtensionReport
) -> dict[str, Any]:
    """The document of a fit that has an effect more than its parent; `asked` is the request that it comes from."""
    if parent.varying is None:
        found = extended_documents(grown.model)
    else:
        found = extended_affine_documents(grown.model, parent)
    inherited = parent.as_json()
    return {
        **{name: inherited[name] for name in INHERITED},
        **{name: asked[name] for name in ASKED},
        "softwareVersion": __version__,
        "origin": "extended",
        "localModels": [],
        "designId": None,
        "parentId": parent_id,
        **found,
        "outcome": outcome_document(grown.outcome).as_json(),
        "tests": [report.after.lack_of_fit.as_json()],
        "extension": report.as_json(),
    }
