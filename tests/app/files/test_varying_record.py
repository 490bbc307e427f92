"""Files of records along varying scheduling: every way to name and arrange their columns, and what is refused."""

import numpy as np
import pytest

from app.files import csv_writer, mat_writer, npz_writer
from app.files.contents import FileError
from app.files.varying_record import VaryingStatements, read_varying
from identification.errors import RangeError
from identification.scheduling import SchedulingVariable

VARIABLES = tuple(SchedulingVariable(name, "", -1.0, 1.0) for name in ("Wind speed", "load"))
STATED = VaryingStatements(VARIABLES, sample_time=0.5)
G = np.random.default_rng(1)
U, Y, P = G.standard_normal((30, 2)), G.standard_normal((30, 1)), G.uniform(-1, 1, (30, 2))
WRITERS = {"csv": csv_writer.write, "npz": npz_writer.write, "mat": mat_writer.write}


def columns(**named: np.ndarray) -> dict[str, np.ndarray]:
    return {"u1": U[:, 0], "u2": U[:, 1], "y": Y[:, 0], **named}


@pytest.mark.parametrize("kind", WRITERS)
def test_columns_by_number_or_by_the_names_of_the_variables(kind: str) -> None:
    by_number = columns(p2=P[:, 1], p1=P[:, 0])
    by_name = columns(load=P[:, 1], wind_speed=P[:, 0])
    for arrays in (by_number, by_name):
        found = read_varying(WRITERS[kind](arrays), kind, STATED).record
        assert np.array_equal(found.input, U)
        assert np.array_equal(found.output, Y)
        assert np.array_equal(found.scheduling, P)
        assert (found.sample_time, found.period, found.variables) == (0.5, None, VARIABLES)


@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_arrays_may_hold_all_channels(kind: str) -> None:
    arrays = {"inputs": U, "output": Y, "scheduling": P, "time": 0.5 * np.arange(30.0), "period": np.array(10.0)}
    found = read_varying(WRITERS[kind](arrays), kind, VaryingStatements(VARIABLES)).record
    assert np.array_equal(found.input, U)
    assert np.array_equal(found.scheduling, P)
    assert (found.sample_time, found.period) == (0.5, 10)


def test_named_columns_go_first() -> None:
    arrays = columns(p1=0 * P[:, 0], p2=0 * P[:, 1], a=P[:, 0], b=P[:, 1])
    found = read_varying(csv_writer.write(arrays), "csv", VaryingStatements(VARIABLES, 0.5, columns=("a", "b"))).record
    assert np.array_equal(found.scheduling, P)


@pytest.mark.parametrize(
    ("arrays", "reason"),
    [
        (columns(), "no scheduling"),
        ({"u1": U[:, 0], "p1": P[:, 0], "p2": P[:, 1]}, "no output"),
        (columns(p1=P[:, 0], p3=P[:, 1]), "numbered"),
        (columns(u=U[:, 0], p1=P[:, 0], p2=P[:, 1]), "same channel"),
        (columns(p1=P[:, 0], p2=np.where(np.arange(30) == 4, np.nan, P[:, 1])), "position 4"),
    ],
)
def test_what_cannot_be_read_says_why(arrays: dict[str, np.ndarray], reason: str) -> None:
    with pytest.raises(FileError, match=reason):
        read_varying(npz_writer.write(arrays), "npz", STATED)


def test_scheduling_outside_the_declared_range_is_refused() -> None:
    with pytest.raises(RangeError, match="Wind speed runs"):
        read_varying(csv_writer.write(columns(p1=2 * P[:, 0], p2=P[:, 1])), "csv", STATED)
    with pytest.raises(FileError, match="differ in length"):
        read_varying(npz_writer.write(columns(p1=P[:20, 0], p2=P[:, 1])), "npz", STATED)
