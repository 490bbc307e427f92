"""Comparisons: what was found of one part of the data, to documents and arrays."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.arrays import finite_or_none
from app.conversion.models import test_documents
from app.schemas.comparisons import (
    BandTest,
    ComparedExperiment,
    ComparisonPart,
    Data,
    DisturbanceDocument,
    NoteDocument,
    PointTest,
)
from app.schemas.experiments import Experiment
from app.schemas.outcomes import TestDocument
from identification.comparison.batch import Batch
from identification.comparison.compare import Comparison, bands
from identification.comparison.disturbance import Disturbance
from identification.outcome import TestResult


def part_document(
    data: Data, found: Comparison, batches: Sequence[Batch], experiments: Sequence[Experiment]
) -> ComparisonPart:
    """The tests of one part of the data, measured in these experiments."""
    points = np.unique(np.concatenate([one.points for one in found.maps]), axis=0)
    by_point = zip(points, test_documents(found.by_point), strict=True) if found.by_point else ()
    return ComparisonPart(
        data=data,
        noise_known=found.overall is not None,
        lack_of_fit=_test(found.overall),
        refitted=_test(found.refitted),
        by_point=[PointTest(operating_point=point.tolist(), test=test) for point, test in by_point],
        by_band=_bands(found, batches),
        by_line_class=test_documents(found.by_class),
        dependence=_test(found.dependence),
        dynamics=_test(found.dynamics),
        between_harmonics=test_documents(found.between),
        disturbances=[_disturbance(experiments[m].id, one) for m, one in found.disturbances],
        notes=[NoteDocument(experiment_id=experiments[m].id, text=text) for m, text in found.notes],
    )


def _disturbance(experiment_id: str, found: Disturbance) -> DisturbanceDocument:
    return DisturbanceDocument(
        experiment_id=experiment_id,
        frequency_rad_per_second=found.frequency,
        frequency_deviation_rad_per_second=found.frequency_deviation,
        amplitude=found.amplitude,
        amplitude_deviation=found.amplitude_deviation,
        phase_rad=found.phase,
        p_value=found.p_value,
    )


def compared_experiments(data: Data, found: Comparison, experiments: Sequence[Experiment]) -> list[ComparedExperiment]:
    """Fit in per cent of the experiments of one part, in the order given."""
    brought = [None] * len(experiments) if found.refit_percent is None else found.refit_percent.tolist()
    return [
        ComparedExperiment(
            experiment_id=experiment.id,
            operating_point=experiment.held_at,
            data=data,
            fit_percent=finite_or_none(float(percent)),
            refit_percent=None if refit is None else finite_or_none(refit),
        )
        for experiment, percent, refit in zip(experiments, found.fit_percent, brought, strict=True)
    ]


def map_arrays(found: Comparison, places: Sequence[int]) -> dict[str, NDArray[Any]]:
    """Frequencies, residuals and line classes of each experiment by its place in the request; compared lines only.

    And its responses, at the excited ones of them.
    """
    arrays: dict[str, NDArray[Any]] = {}
    for one in found.maps:
        for m, member in enumerate(one.members):
            used, place = one.compared[m], places[int(member)]
            arrays[f"frequenciesRadPerSecond{place}"] = one.frequencies[used]
            arrays[f"residual{place}"] = one.residual[m, used]
            arrays[f"lineClass{place}"] = one.classes[m, used]
            responses, shown = one.responses, one.responses.shown[m]
            arrays[f"excitedRadPerSecond{place}"] = one.frequencies[shown]
            arrays[f"measured{place}"] = responses.measured[m, shown]
            arrays[f"modelled{place}"] = responses.modelled[m, shown]
            if responses.deviation is not None:
                arrays[f"deviation{place}"] = responses.deviation[m, shown]
    return arrays


def _bands(found: Comparison, batches: Sequence[Batch]) -> list[BandTest]:
    if not found.by_band:
        return []
    pairs = zip(bands(batches), test_documents(found.by_band), strict=True)
    return [
        BandTest(minimum_rad_per_second=max(low, 0.0), maximum_rad_per_second=finite_or_none(high), test=test)
        for (low, high), test in pairs
    ]


def _test(result: TestResult | None) -> TestDocument | None:
    return None if result is None else test_documents((result,))[0]
