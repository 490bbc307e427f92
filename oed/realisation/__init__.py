"""Designed spectra as signals to play: multisines with exact lines and a low crest factor, and filtered noise."""

from oed.realisation.filtered_noise import energy_deviation, filtered_noise
from oed.realisation.lines import signal_line_energies
from oed.realisation.multisine import crest_factor, multisine
from oed.realisation.realise import realise
from oed.realisation.realised_signal import RealisedSignal
from oed.realisation.spectral_factor import spectral_factor

__all__ = [
    "RealisedSignal",
    "crest_factor",
    "energy_deviation",
    "filtered_noise",
    "multisine",
    "realise",
    "signal_line_energies",
    "spectral_factor",
]
