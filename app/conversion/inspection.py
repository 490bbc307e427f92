"""What was understood of a measurement, as a document."""

import numpy as np

from app.schemas.experiments import Understanding
from identification.signals import Measurement, TimeRecord


def understanding(data: Measurement) -> Understanding:
    """The document of what was understood."""
    if isinstance(data, TimeRecord):
        return Understanding(
            samples=len(data),
            duration_seconds=len(data) * data.sample_time,
            period_samples=data.period,
            periods=data.period_count if data.period else None,
            frequency_count=0,
            minimum_frequency_rad_per_second=None,
            maximum_frequency_rad_per_second=None,
            noise_level=None,
            warnings=[],
        )
    return Understanding(
        samples=None,
        duration_seconds=None,
        period_samples=None,
        periods=None,
        frequency_count=len(data),
        minimum_frequency_rad_per_second=float(np.min(data.frequencies)),
        maximum_frequency_rad_per_second=float(np.max(data.frequencies)),
        noise_level=None,
        warnings=[],
    )
