"""The frequency response of a record, to be looked at."""

from dataclasses import replace

from identification.measurements.inspection import find_period
from identification.signals import FrequencyResponse, TimeRecord
from identification.spectral.local_polynomial import LocalPolynomial
from identification.spectral.periodic_average import PeriodicAverage

LEAST_PERIODS = 2
MOST_LINES = 2000


def measured_response(record: TimeRecord) -> FrequencyResponse:
    """Ĝ at the excited lines with its variance: averaged over periods where there are two, else by local polynomials.

    Neighbours of a response by local polynomials share data; it is one to draw, not to fit, with `MOST_LINES` at most.
    Raises MisuseError for records from which no response can be had.
    """
    period = record.period or find_period(record.input)
    if period is not None and len(record) // period >= LEAST_PERIODS:
        return PeriodicAverage(real_lines=False).estimate(replace(record, period=period))
    return LocalPolynomial(stride=1 + len(record) // (2 * MOST_LINES)).estimate(record)
