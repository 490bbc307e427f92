"""What there is to choose from."""

from typing import Any

from pydantic import Field

from app.schemas.common import CamelModel


class CatalogueOption(CamelModel):
    """One option of a plug-in."""

    name: str = Field(description="name of the field")
    description: str = Field(description="what it is, with its unit")
    required: bool
    value_schema: dict[str, Any] = Field(description="JSON schema of its values")


class CatalogueEntry(CamelModel):
    """One plug-in."""

    kind: str = Field(description="what to give as `kind`")
    description: str
    options: list[CatalogueOption]


class Catalogue(CamelModel):
    """All estimators, targets, spectrum families and basis functions of this service."""

    software_version: str
    bases: list[CatalogueEntry] = Field(description="functions of one scheduling variable")
    spectral_estimators: list[CatalogueEntry] = Field(description="records to frequency responses")
    local_estimators: list[CatalogueEntry] = Field(description="models of one operating point")
    lpv_estimators: list[CatalogueEntry] = Field(description="parameter-varying models")
    subspace_estimators: list[CatalogueEntry] = Field(description="state-space models of one operating point")
    parametric_estimators: list[CatalogueEntry] = Field(description="parameter-varying state-space models")
    refinements: list[CatalogueEntry] = Field(description="what improves a parameter-varying state-space model")
    pole_regions: list[CatalogueEntry] = Field(description="where the poles of state-space models must lie")
    targets: list[CatalogueEntry] = Field(description="accuracy targets of designs")
    spectrum_families: list[CatalogueEntry] = Field(description="input spectra of designs")
