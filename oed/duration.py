"""How long the local experiments must be for the accuracy of the noise model."""

import numpy as np

from identification.arrays import FloatArray


def required_samples(noise_information: FloatArray, targets: FloatArray) -> float:
    """The least N_p with N_p Σ_m X^H(p_m) ⪰ R_H,j for every target j; infinite when no duration suffices.

        N_p > max_j λ_max((Σ_m X^H(p_m))⁻¹ R_H,j)                                            [Ghosh2018, (18)]

    `noise_information` X^H (M, k_H, k_H) of the operating points of the design, `targets` R_H (J, k_H, k_H), already
    lessened by prior information. Zero when no target concerns the noise model.
    """
    total = noise_information.sum(axis=0)
    if targets.size == 0 or np.linalg.eigvalsh(targets)[:, -1].max() <= 0:
        return 0.0
    scale = np.sqrt(np.maximum(np.diagonal(total), 1e-300))
    values, vectors = np.linalg.eigh(total / np.outer(scale, scale))
    if values[0] < 1e-12 * values[-1]:
        return np.inf
    root = vectors / np.sqrt(values) / scale[:, None]
    return float(max(np.linalg.eigvalsh(root.T @ targets @ root)[:, -1].max(), 0.0))


def supplementary_points(noise_information: FloatArray, total: FloatArray, targets: FloatArray) -> list[int]:
    """Operating points at which records without input, added to `total` (k_H, k_H), make a finite duration suffice.

    Chosen one by one, the most informative first, from X^H (M, k_H, k_H); empty when even all of them do not suffice.
    """
    if not np.isfinite(required_samples(noise_information + total / len(noise_information), targets)):
        return []
    scale = np.sqrt(np.diagonal(noise_information.sum(axis=0)))
    candidates, known = noise_information / np.outer(scale, scale), total / np.outer(scale, scale)
    chosen: list[int] = []
    while not np.isfinite(required_samples(known[None], targets / np.outer(scale, scale))):
        sums = known + candidates + 1e-9 * np.eye(len(scale))
        chosen.append(int(np.argmax(np.linalg.slogdet(sums)[1])))
        known = known + candidates[chosen[-1]]
    return chosen
