"""Comparisons with records along varying scheduling, to documents and arrays."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.conversion.models import test_documents
from app.schemas.comparisons import BandTest, ComparedExperiment, ComparisonPart, Data
from app.schemas.models import Model
from app.schemas.plug_ins import PlugInDocument
from identification.arrays import FloatArray
from identification.varying.comparison import VaryingComparison


def varying_part(data: Data, experiment_id: str, found: VaryingComparison) -> ComparisonPart:
    """The tests of one record."""
    bands = zip(pairwise(found.edges), test_documents(found.by_band), strict=True)
    overall = () if found.lack_of_fit is None else (found.lack_of_fit,)
    return ComparisonPart(
        data=data,
        scheduling="varying",
        experiment_id=experiment_id,
        noise_known=found.noise_known,
        lack_of_fit=next(iter(test_documents(overall)), None),
        by_point=[],
        by_band=[
            BandTest(minimum_rad_per_second=float(low), maximum_rad_per_second=float(high), test=test)
            for (low, high), test in bands
        ],
        by_line_class=[],
        dependence=None,
        dynamics=None,
        between_harmonics=[],
        simulation_errors=test_documents(found.tests),
    )


def varying_compared(data: Data, experiment_id: str, found: VaryingComparison) -> ComparedExperiment:
    """How well the record is reproduced."""
    return ComparedExperiment(
        experiment_id=experiment_id,
        operating_point=None,
        data=data,
        fit_percent=found.best_fit_rate,
        vaf_percent=found.variance_accounted_for,
    )


def varying_arrays(found: VaryingComparison, place: int) -> dict[str, NDArray[Any]]:
    """Residuals over frequency (F, n_y) and over time (N, n_y) of the record at a place in the request."""
    return {
        f"frequenciesRadPerSecond{place}": found.frequencies,
        f"residual{place}": found.residual,
        f"lineClass{place}": np.zeros(len(found.frequencies), dtype=np.int64),
        f"timeResidual{place}": found.errors,
    }


def noise_of(model: Model) -> FloatArray | None:
    """The covariance of the noise on the record that a model was fitted to."""
    assert model.varying is not None, "only models from varying scheduling"
    spectrum = model.varying.noise_spectrum
    return None if spectrum is None else np.array(spectrum.covariance)


def period_options(model: Model) -> dict[str, Any]:
    """How the estimator of a model takes periods, for other records of the same kind."""
    assert model.varying is not None, "only models from varying scheduling"
    asked: list[PlugInDocument | None] = [model.varying.refinement, model.varying.estimator]
    for one in filter(None, asked):
        built = one.build()
        if hasattr(built, "drop_periods"):
            return {"drop_periods": built.drop_periods, "tolerance": built.tolerance}
    return {}
