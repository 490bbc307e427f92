"""What there is to choose from."""

from typing import Any, Literal

from pydantic import Field

from app.schemas.common import CamelModel, Double, Integer
from app.schemas.diagnoses import Domain
from app.schemas.experiments import ExperimentKind


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


class MethodEntry(CamelModel):
    """A way from experiments to a model, and what it takes."""

    kind: str
    description: str
    request_kind: Literal["rational", "stateSpace", "varyingScheduling"] = Field(
        description="the kind of `POST /v1/models` that asks for it"
    )
    experiments: list[ExperimentKind] = Field(description="the kinds of experiments that it takes")
    structures: list[str] = Field(description="the time domains of the structures that it takes")
    takes_prior: bool = Field(description="whether the information of an earlier model can be added")


class EffectParameterEntry(CamelModel):
    """A parameter of an effect besides its amplitude."""

    name: str
    quantity: Literal["frequency", "time", "input", "output", "displacement", "flow", "number"] = Field(
        description="what it is"
    )
    fitted: bool = Field(description="adjusted together with the amplitude; else only searched")


class EffectEntry(CamelModel):
    """A physical effect that models may lack and be extended by."""

    kind: str = Field(description="what to name in `effects` or `effect`")
    title: str
    description: str
    domain: Domain = Field(description="the kind of plant it belongs to")
    place: str = Field(description="where it acts")
    unit: str = Field(description="unit of its amplitude")
    sign: Literal["any", "positive", "negative"] = Field(description="of a physical amplitude")
    largest_amplitude: Double | None = Field(description="largest physical size; null when there is no bound")
    needs_records: bool = Field(description="shows only in periodic records, not in frequency responses")
    amplitudes: Integer = Field(description="how many amplitudes it has")
    parameters: list[EffectParameterEntry]
    source: str = Field(description="where it is described")


class Catalogue(CamelModel):
    """All estimators, targets, spectrum families, basis functions and physical effects of this service."""

    software_version: str
    methods: list[MethodEntry] = Field(description="ways from experiments to models, with what they take")
    bases: list[CatalogueEntry] = Field(description="functions of one scheduling variable")
    spectral_estimators: list[CatalogueEntry] = Field(description="records to frequency responses")
    local_estimators: list[CatalogueEntry] = Field(description="models of one operating point")
    lpv_estimators: list[CatalogueEntry] = Field(description="parameter-varying models")
    subspace_estimators: list[CatalogueEntry] = Field(description="state-space models of one operating point")
    parametric_estimators: list[CatalogueEntry] = Field(description="parameter-varying state-space models")
    refinements: list[CatalogueEntry] = Field(description="what improves a parameter-varying state-space model")
    varying_estimators: list[CatalogueEntry] = Field(
        description="state-space models over functions of the scheduling, from records in which it varies"
    )
    varying_refinements: list[CatalogueEntry] = Field(
        description="what improves a state-space model from varying scheduling"
    )
    pole_regions: list[CatalogueEntry] = Field(description="where the poles of state-space models must lie")
    targets: list[CatalogueEntry] = Field(description="accuracy targets of designs")
    limits: list[CatalogueEntry] = Field(description="what the plant may not do in a design")
    spectrum_families: list[CatalogueEntry] = Field(description="input spectra of designs")
    effects: list[EffectEntry] = Field(description="what a diagnosis looks for and models are extended by")
