"""Designed spectra to documents and back."""

import numpy as np

from app.arrays import ComplexVector
from app.schemas.designs import (
    FirSpectrumDocument,
    LineSpectrumDocument,
    MultisineSpectrumDocument,
    Spectrum,
    SpectrumCurve,
)
from oed.spectra.fir import FirSpectrum
from oed.spectra.lines import LineSpectrum
from oed.spectra.multisines import MultisineSpectrum

CURVE_POINTS = 201
Designed = FirSpectrum | LineSpectrum | MultisineSpectrum


def spectrum_document(spectrum: Designed) -> Spectrum:
    """The document of a designed spectrum."""
    if isinstance(spectrum, LineSpectrum):
        return LineSpectrumDocument(
            kind="lines",
            line_indices=spectrum.indices.tolist(),
            frequencies_rad_per_second=spectrum.frequencies.tolist(),
            energies=spectrum.energies.tolist(),
            period_samples=spectrum.samples,
        )
    if isinstance(spectrum, MultisineSpectrum):
        return MultisineSpectrumDocument(
            kind="multisine",
            line_indices=spectrum.indices.tolist(),
            frequencies_rad_per_second=spectrum.frequencies.tolist(),
            phasors=ComplexVector.of(spectrum.phasors),
            level=spectrum.level,
            energies=(spectrum.periods * spectrum.period_energies).tolist(),
            period_samples=spectrum.samples,
            periods=spectrum.periods,
        )
    return FirSpectrumDocument(kind="fir", coefficients=spectrum.coefficients.tolist())


def spectrum_object(document: Spectrum, sample_time: float) -> Designed:
    """The designed spectrum of a document."""
    if isinstance(document, LineSpectrumDocument):
        return LineSpectrum(
            np.array(document.frequencies_rad_per_second),
            np.array(document.energies),
            np.array(document.line_indices, dtype=np.int64),
            document.period_samples,
        )
    if isinstance(document, MultisineSpectrumDocument):
        return MultisineSpectrum(
            np.array(document.frequencies_rad_per_second),
            np.array(document.line_indices, dtype=np.int64),
            document.phasors.array(),
            document.period_samples,
            document.periods,
        )
    return FirSpectrum(np.array(document.coefficients), sample_time)


def curve(spectrum: Designed, sample_time: float) -> SpectrumCurve:
    """What to plot: the lines, or the density up to the Nyquist frequency."""
    if isinstance(spectrum, LineSpectrum):
        return SpectrumCurve(
            frequencies_rad_per_second=spectrum.frequencies.tolist(), values=spectrum.energies.tolist()
        )
    if isinstance(spectrum, MultisineSpectrum):
        energies = spectrum.periods * spectrum.period_energies
        return SpectrumCurve(frequencies_rad_per_second=spectrum.frequencies.tolist(), values=energies.tolist())
    omega = np.linspace(0, np.pi / sample_time, CURVE_POINTS)
    return SpectrumCurve(frequencies_rad_per_second=omega.tolist(), values=spectrum.density(omega).tolist())
