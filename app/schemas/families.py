"""The families of plug-ins that requests choose from, each a named union."""

from typing import TYPE_CHECKING

import identification.bases
import identification.lpv
import identification.lti
import identification.spectral
import oed.spectra
import oed.targets
from app.schemas.plug_ins import PlugInDocument, PlugInFamily

BASES = PlugInFamily("Basis", "Basis", identification.bases)
SPECTRAL_ESTIMATORS = PlugInFamily("SpectralEstimator", "Estimator", identification.spectral)
LOCAL_ESTIMATORS = PlugInFamily("LocalEstimator", "Estimator", identification.lti)
LPV_ESTIMATORS = PlugInFamily("LpvEstimator", "Estimator", identification.lpv)
TARGETS = PlugInFamily("AccuracyTarget", "Target", oed.targets)
SPECTRUM_FAMILIES = PlugInFamily("SpectrumFamily", "Family", oed.spectra)

FAMILIES = {
    "bases": BASES,
    "spectralEstimators": SPECTRAL_ESTIMATORS,
    "localEstimators": LOCAL_ESTIMATORS,
    "lpvEstimators": LPV_ESTIMATORS,
    "targets": TARGETS,
    "spectrumFamilies": SPECTRUM_FAMILIES,
}

if TYPE_CHECKING:
    Basis = PlugInDocument
    SpectralEstimator = PlugInDocument
    LocalEstimator = PlugInDocument
    LpvEstimator = PlugInDocument
    AccuracyTarget = PlugInDocument
    SpectrumFamily = PlugInDocument
else:
    Basis = BASES.union
    SpectralEstimator = SPECTRAL_ESTIMATORS.union
    LocalEstimator = LOCAL_ESTIMATORS.union
    LpvEstimator = LPV_ESTIMATORS.union
    AccuracyTarget = TARGETS.union
    SpectrumFamily = SPECTRUM_FAMILIES.union
