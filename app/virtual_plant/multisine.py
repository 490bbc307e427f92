"""Forces to begin with, before anything has been designed."""

import numpy as np

from identification.arrays import FloatArray

EXCITED = 0.75


def random_phases(levels: FloatArray, length: int, highest: int, generator: np.random.Generator) -> FloatArray:
    """One period (M, length) of multisines of these root mean squares, on three quarters of the lines 1 … `highest`.

    The same lines for all, with phases of their own; what the plant answers at the lines left out is not linear.
    """
    lines = np.sort(generator.choice(np.arange(1, highest + 1), round(EXCITED * highest), replace=False))
    phases = generator.uniform(0, 2 * np.pi, (len(levels), len(lines)))
    spectra = np.zeros((len(levels), length // 2 + 1), dtype=np.complex128)
    spectra[:, lines] = levels[:, None] * np.sqrt(2 / len(lines)) * np.exp(1j * phases)
    return np.asarray(np.fft.irfft(spectra * length / 2, n=length))
