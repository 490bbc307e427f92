"""From parts of periods to whole ones."""

from dataclasses import replace

import numpy as np

from identification.arrays import FloatArray, IntArray
from oed.column_generation import CertifiedSpectra
from oed.spectra.multisines import LEAST_PERIODS, MultisinePricing

MET = -1e-9


def whole_periods(
    pricing: MultisinePricing, solution: CertifiedSpectra, targets: FloatArray, limits: FloatArray
) -> CertifiedSpectra:
    """Every experiment with whole periods, at least two, that meet the targets R_j (J, k, k) with little more energy.

    Periods are rounded up, then taken away again one by one, the dearest first, as long as the targets stay met. The
    lower bound remains that of parts of periods; the energy becomes that of whole ones.
    """
    used, first, member = np.unique([block.point for block in solution.blocks], return_index=True, return_inverse=True)
    blocks = [solution.blocks[i] for i in first]
    exact = np.bincount(member, pricing.periods(solution.blocks, solution.weights))
    most = np.maximum(np.rint(limits[used] / pricing.energies[used]), LEAST_PERIODS)
    counts = np.minimum(np.maximum(np.ceil(exact - 1e-6), LEAST_PERIODS), most).astype(np.int64)
    energies = pricing.energies[used]
    counts = _fewer(counts, pricing.information[used] * energies[:, None, None], energies, targets)
    kept = np.flatnonzero(counts)
    return replace(
        solution,
        blocks=[blocks[i] for i in kept],
        weights=[np.full((1, 1), counts[i] * energies[i]) for i in kept],
        energy=float(counts @ energies),
    )


def _fewer(counts: IntArray, information: FloatArray, energies: FloatArray, targets: FloatArray) -> IntArray:
    """Periods taken away where all targets stay met; `information` (C, k, k) of one period."""
    order = np.argsort(-energies, kind="stable")
    changed = True
    while changed:
        changed = False
        for i in order[counts[order] > 0]:
            trial = counts.copy()
            trial[i] = trial[i] - 1 if trial[i] > LEAST_PERIODS else 0
            total = np.einsum("c,cij->ij", trial, information)
            if np.linalg.eigvalsh(total - targets)[:, 0].min() >= MET:
                counts, changed = trial, True
    return counts
