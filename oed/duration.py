"""How long the local experiments must be for the accuracy of the noise model."""

import numpy as np

from identification.arrays import FloatArray
from oed.pencil import Pencil


def required_samples(noise_information: FloatArray, targets: FloatArray, prior: FloatArray | None = None) -> float:
    """The least N_p with Π_H + N_p Σ_m X^H(p_m) ⪰ R_H,j for every target j; infinite when no duration suffices.

        N_p > max_j λ_max((Σ_m X^H(p_m))⁻¹ R_H,j)   without prior information Π_H              [Ghosh2018, (18)]

    `noise_information` X^H (M, k_H, k_H) of the operating points of the design, `targets` R_H (J, k_H, k_H), `prior`
    Π_H (k_H, k_H). Zero when prior information meets all targets.
    """
    total = noise_information.sum(axis=0)
    if targets.size == 0:
        return 0.0
    return Pencil.of(np.zeros_like(total) if prior is None else prior, total).least(targets)


def supplementary_points(noise_information: FloatArray, known: FloatArray, targets: FloatArray) -> list[int]:
    """Operating points at which records without input, beside what is `known` (k_H, k_H), make a finite duration do.

    Chosen one by one, the most informative first, from X^H (M, k_H, k_H); empty when even all of them do not suffice.
    """
    if not np.isfinite(required_samples(noise_information, targets, known)):
        return []
    scale = np.sqrt(np.diagonal(noise_information.sum(axis=0) + known))
    scale = np.where(scale > 0, scale, 1.0)
    candidates, sum_known = noise_information / np.outer(scale, scale), known / np.outer(scale, scale)
    asked = targets / np.outer(scale, scale)
    chosen: list[int] = []
    while not np.isfinite(required_samples(candidates[chosen], asked, sum_known)):
        sums = sum_known + candidates[chosen].sum(axis=0) + candidates + 1e-9 * np.eye(len(scale))
        chosen.append(int(np.argmax(np.linalg.slogdet(sums)[1])))
    return chosen
