"""Multisines of a design played on the virtual bench, with noise of a stated size."""

from collections.abc import Sequence

import numpy as np

from benchmarks.virtual_bench.bench import PERIOD, SAMPLE_TIME, STEPS, Bench, Experiments, on_half_steps
from identification.channels import Channel, Channels
from identification.signals import TimeRecord
from oed.spectra.multisines import MultisineSpectrum

Played = tuple[float, MultisineSpectrum]
CHANNELS = Channels(Channel(quantity="force"), Channel(quantity="position"))


def energy(played: Sequence[Played]) -> float:
    """Σ u² of all experiments."""
    return sum(spectrum.energy for _, spectrum in played)


def experiments_of(played: Sequence[Played]) -> Experiments:
    """The experiments as the bench takes them."""
    lines = np.arange(1, PERIOD // 2)
    phasors = np.zeros((len(played), len(lines)), dtype=complex)
    for row, (_, spectrum) in zip(phasors, played, strict=True):
        row[spectrum.indices - 1] = spectrum.phasors
    points = np.array([point for point, _ in played])
    return Experiments(points, *on_half_steps(phasors, lines), phasors, lines)


def steady(played: Sequence[Played], hidden: Sequence[tuple[str, float]]) -> tuple[Experiments, np.ndarray]:
    """The experiments and one noise-free period of each output, with these effects hidden."""
    done = experiments_of(played)
    return done, Bench(tuple(hidden)).steady(done)


def records(
    played: Sequence[Played], flows: tuple[Experiments, np.ndarray], sigma: float, generator: np.random.Generator
) -> list[TimeRecord]:
    """All periods of every experiment, white noise of standard deviation `sigma` on the output."""
    done, outputs = flows
    found = []
    for m, (point, spectrum) in enumerate(played):
        u = np.tile(done.inputs[m, :: 2 * STEPS], spectrum.periods)
        y = np.tile(outputs[m], spectrum.periods)
        noise = sigma * generator.standard_normal(len(y))
        found.append(TimeRecord(u, y + noise, SAMPLE_TIME, (float(point),), PERIOD, CHANNELS))
    return found
