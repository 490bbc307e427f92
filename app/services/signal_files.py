"""The samples of signals, on their way out."""

import numpy as np

from app.container import Container
from app.conversion.misuse import pointing
from app.errors import UnprocessableError
from app.files.stored import SignalFormat, arrays_file, wav
from app.services.signals import KIND, signals_of


def samples_file(container: Container, signals_id: str, index: int, file_format: SignalFormat) -> bytes:
    """All samples of one signal as a file."""
    resource = container.resources.get(KIND, signals_id)
    made = signals_of(resource).signals
    if index >= len(made):
        raise UnprocessableError.at("/index", f"there are {len(made)} signals, numbered from 0", "query")
    assert resource.arrays is not None, "signals have arrays"
    signal = made[index]
    record = np.tile(container.arrays.get(resource.arrays)[f"period{index}"], signal.periods)
    if file_format == "wav":
        with pointing({}, "/format", "query"):
            return wav(record, signal.sample_time_seconds)
    time = np.arange(len(record)) * signal.sample_time_seconds
    arrays = {"time": time, "input": record}
    if file_format != "csv":
        arrays |= {
            "operatingPoint": np.array(signal.operating_point),
            "sampleTimeSeconds": np.array(signal.sample_time_seconds),
            "periodSamples": np.array(float(signal.period_samples)),
        }
    return arrays_file(arrays, file_format)
