"""The design that decides between effects that a diagnosis could not tell apart, as a request ready to post."""

from collections.abc import Sequence

import numpy as np
from pydantic import TypeAdapter

from app.schemas.designs import DesignRequest, PointGrid
from app.schemas.experiments import Experiment
from app.schemas.families import AccuracyTarget, SpectrumFamily
from identification.comparison.batch import Batch
from identification.diagnosis.diagnose import Diagnosis
from oed.hypothesis import sample_noise_variance

MOST_RIVALS = 3
LEVELS = (0.25, 0.5, 1.0)
LONGER = 4
TOLERANCE = 1e-3


def deciding_design(
    found: Diagnosis, experiments: Sequence[Experiment], plant_id: str, model_id: str
) -> DesignRequest | None:
    """The best announced effect against the others, at the points, periods and up to the levels of the experiments.

    None where there is nothing to decide, or where some of the experiments are not periodic records.
    """
    kinds = [
        one.score.candidate.effect.kind for one in found.announced if not one.score.candidate.effect.of_measurements
    ]
    kinds = list(dict.fromkeys(kinds))[: 1 + MOST_RIVALS]
    batches = found.base.rows.batches
    if len(kinds) < 2 or any(batch.signals is None for batch in batches):
        return None
    longest = max(batches, key=_period)
    targets = [{"kind": "effect_discrimination", "effect": kinds[0], "against": other} for other in kinds[1:]]
    family = {"kind": "multisines", "samples": _period(longest), "levels": _levels(batches)}
    points = np.unique(np.concatenate([batch.points for batch in batches]), axis=0)
    return DesignRequest(
        plant_id=plant_id,
        model_id=model_id,
        name="which of " + ", ".join(kinds),
        operating_points=PointGrid(kind="grid", points=points.tolist()),
        targets=TypeAdapter(list[AccuracyTarget]).validate_python(targets),
        spectrum_family=TypeAdapter(SpectrumFamily).validate_python(family),
        samples=LONGER * max(one.understood.samples or _period(longest) for one in experiments),
        sample_time_seconds=longest.sample_time,
        prior_experiment_ids=[one.id for one in experiments],
        noise_variance=float(np.mean([sample_noise_variance(batch) for batch in batches])),
        tolerance=TOLERANCE,
    )


def _period(batch: Batch) -> int:
    assert batch.signals is not None, "periodic records"
    return int(batch.signals.shape[1])


def _levels(batches: Sequence[Batch]) -> list[float]:
    """Shares of the largest root mean square that was played; nothing stronger."""
    largest = max(float(batch.signals.std(axis=1).max()) for batch in batches if batch.signals is not None)
    return [share * largest for share in LEVELS]
