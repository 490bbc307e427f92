"""The families of plug-ins that requests choose from, each a named union."""

import dataclasses
import inspect
import typing
from typing import TYPE_CHECKING, Any

import identification.bases
import identification.lpv
import identification.lti
import identification.parametric
import identification.pole_regions
import identification.spectral
import identification.subspace
import identification.varying
import oed.limits
import oed.spectra
import oed.targets
from app.schemas.plug_ins import PlugInDocument, PlugInFamily
from identification.pole_regions.inequality import PoleRegion as AnyRegion


def _is_simple(region: type[Any]) -> bool:
    """Whether a pole region is made of no others."""
    hints = typing.get_type_hints(region)
    return not any(AnyRegion in typing.get_args(hints[field.name]) for field in dataclasses.fields(region))


def _refines(estimator: type[Any]) -> bool:
    """Whether an estimator begins with a model that another one has found."""
    return "start" in inspect.signature(estimator.estimate).parameters


def _begins_alone(estimator: type[Any]) -> bool:
    """Whether an estimator needs no model to begin with, though it may take one."""
    start = inspect.signature(estimator.estimate).parameters.get("start")
    return start is None or start.default is not inspect.Parameter.empty


def _begins(estimator: type[Any]) -> bool:
    return not _refines(estimator)


ORDER = frozenset({"order"})

BASES = PlugInFamily("Basis", "Basis", identification.bases)
SPECTRAL_ESTIMATORS = PlugInFamily("SpectralEstimator", "Estimator", identification.spectral)
LOCAL_ESTIMATORS = PlugInFamily("LocalEstimator", "Estimator", identification.lti)
LPV_ESTIMATORS = PlugInFamily("LpvEstimator", "Estimator", identification.lpv)
SIMPLE_POLE_REGIONS = PlugInFamily("SimplePoleRegion", "Region", identification.pole_regions, only=_is_simple)
POLE_REGIONS = PlugInFamily(
    "PoleRegion",
    "Region",
    identification.pole_regions,
    nested={AnyRegion: SIMPLE_POLE_REGIONS.union},
    parts=SIMPLE_POLE_REGIONS,
)
REGIONS = {AnyRegion: POLE_REGIONS.union}
SUBSPACE_ESTIMATORS = PlugInFamily("SubspaceEstimator", "Estimator", identification.subspace, elsewhere=ORDER)
PARAMETRIC_ESTIMATORS = PlugInFamily(
    "ParametricEstimator", "Estimator", identification.parametric, nested=REGIONS, elsewhere=ORDER, only=_begins
)
REFINEMENTS = PlugInFamily("Refinement", "Refinement", identification.parametric, nested=REGIONS, only=_refines)
VARYING_ESTIMATORS = PlugInFamily("VaryingEstimator", "Estimator", identification.varying, only=_begins_alone)
VARYING_REFINEMENTS = PlugInFamily(
    "VaryingRefinement", "Refinement", identification.varying, parts=VARYING_ESTIMATORS, only=_refines
)
TARGETS = PlugInFamily("AccuracyTarget", "Target", oed.targets)
LIMITS = PlugInFamily("Limit", "Limit", oed.limits)
SPECTRUM_FAMILIES = PlugInFamily("SpectrumFamily", "Family", oed.spectra)

FAMILIES = {
    "bases": BASES,
    "spectralEstimators": SPECTRAL_ESTIMATORS,
    "localEstimators": LOCAL_ESTIMATORS,
    "lpvEstimators": LPV_ESTIMATORS,
    "subspaceEstimators": SUBSPACE_ESTIMATORS,
    "parametricEstimators": PARAMETRIC_ESTIMATORS,
    "refinements": REFINEMENTS,
    "varyingEstimators": VARYING_ESTIMATORS,
    "varyingRefinements": VARYING_REFINEMENTS,
    "poleRegions": POLE_REGIONS,
    "targets": TARGETS,
    "limits": LIMITS,
    "spectrumFamilies": SPECTRUM_FAMILIES,
}

if TYPE_CHECKING:
    Basis = PlugInDocument
    SpectralEstimator = PlugInDocument
    LocalEstimator = PlugInDocument
    LpvEstimator = PlugInDocument
    SubspaceEstimator = PlugInDocument
    ParametricEstimator = PlugInDocument
    Refinement = PlugInDocument
    VaryingEstimator = PlugInDocument
    VaryingRefinement = PlugInDocument
    AccuracyTarget = PlugInDocument
    Limit = PlugInDocument
    SpectrumFamily = PlugInDocument
else:
    Basis = BASES.union
    SpectralEstimator = SPECTRAL_ESTIMATORS.union
    LocalEstimator = LOCAL_ESTIMATORS.union
    LpvEstimator = LPV_ESTIMATORS.union
    SubspaceEstimator = SUBSPACE_ESTIMATORS.union
    ParametricEstimator = PARAMETRIC_ESTIMATORS.union
    Refinement = REFINEMENTS.union
    VaryingEstimator = VARYING_ESTIMATORS.union
    VaryingRefinement = VARYING_REFINEMENTS.union
    AccuracyTarget = TARGETS.union
    Limit = LIMITS.union
    SpectrumFamily = SPECTRUM_FAMILIES.union
