"""The response of a record is that of the filter that made it, with and without a period."""

import numpy as np
import pytest

from identification.measurements.measured_response import MOST_LINES, measured_response
from identification.signals import TimeRecord


@pytest.mark.parametrize(("periods", "least"), [(6, 90), (1, 300)])
def test_a_filtered_record_gives_its_filter(periods: int, least: int) -> None:
    generator = np.random.default_rng(4)
    u = np.tile(generator.standard_normal(1200 // periods), periods)
    y = np.zeros(len(u))
    for t in range(1, len(u)):
        y[t] = 0.7 * y[t - 1] + 0.3 * u[t - 1]
    found = measured_response(TimeRecord(u, y + 1e-3 * generator.standard_normal(len(u)), 0.01, (0.0,)))
    assert len(found.frequencies) >= least
    z = np.exp(-1j * found.frequencies * 0.01)
    error = found.response - 0.3 * z / (1 - 0.7 * z)
    assert found.variance is not None
    assert 0.3 < np.median(abs(error) ** 2 / found.variance) < 2.0


def test_a_long_record_is_drawn_at_no_more_lines_than_can_be_seen():
    u = np.random.default_rng(1).standard_normal(20_000)
    found = measured_response(TimeRecord(u, 0.5 * u, 1.0, (0.0,)))
    assert 1000 < len(found) <= MOST_LINES
    assert np.allclose(found.response, 0.5)
