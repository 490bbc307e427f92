"""Files of measurements: there and back exactly, and damage never ends in anything but a FileError."""

import io
import struct

import numpy as np
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import wavfile

from app.files import csv_writer, mat_writer, npz_writer, wav_file
from app.files.contents import FileError, from_arrays
from app.files.measurement import Statements, measurement, read_measurement
from app.files.readers.mat import MatlabFile
from app.files.stored import arrays_file
from identification.errors import MisuseError, RangeError
from identification.signals import FrequencyResponse, TimeRecord
from tests.support.bad_files import BAD_FILES, good_arrays

POINT = Statements((1.0,))
ARRAYS = good_arrays()
WRITERS = {"csv": csv_writer.write, "npz": npz_writer.write, "mat": mat_writer.write}


def matlab(compressed: bool, **arrays: object) -> bytes:
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, arrays, do_compression=compressed)
    return buffer.getvalue()


@pytest.mark.parametrize("kind", WRITERS)
def test_what_columns_are_can_be_said(kind: str) -> None:
    given = {"t": ARRAYS["time"], "force": ARRAYS["input"], "u": ARRAYS["time"], "way": ARRAYS["output"]}
    stated = Statements((1.0,), columns=("input=force", "output=way"))
    record = read_measurement(WRITERS[kind](given), kind, stated)
    assert isinstance(record, TimeRecord)
    np.testing.assert_array_equal(record.input, ARRAYS["input"])
    np.testing.assert_array_equal(record.output, ARRAYS["output"])
    assert record.sample_time == 1.0


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (("input=power",), "no column or array 'power'; it has time, input, output"),
        (("input=time", "output=time"), "named once"),
        (("input=time", "input=output"), "named once"),
    ],
)
def test_columns_that_are_not_there_are_refused(columns: tuple[str, ...], message: str) -> None:
    with pytest.raises(MisuseError, match=message) as refused:
        read_measurement(csv_writer.write(ARRAYS), "csv", Statements((1.0,), columns=columns))
    assert refused.value.field == "/columns"


@pytest.mark.parametrize("kind", WRITERS)
def test_a_record_comes_back_exactly(kind: str) -> None:
    record = read_measurement(WRITERS[kind](ARRAYS), kind, POINT)
    assert isinstance(record, TimeRecord)
    np.testing.assert_array_equal(record.input, ARRAYS["input"])
    np.testing.assert_array_equal(record.output, ARRAYS["output"])
    assert record.sample_time == 1.0


@pytest.mark.parametrize("kind", ["csv", "npz", "mat"])
def test_a_response_comes_back_exactly(kind: str) -> None:
    generator = np.random.default_rng(1)
    arrays = {
        "frequenciesRadPerSecond": np.linspace(0.1, 2.0, 9),
        "response": generator.normal(size=9) + 1j * generator.normal(size=9),
        "variance": generator.uniform(1, 2, size=9),
        "sampleTimeSeconds": np.array(0.5),
    }
    data = read_measurement(arrays_file(arrays, kind), kind, POINT)
    assert isinstance(data, FrequencyResponse)
    np.testing.assert_array_equal(data.response, arrays["response"])
    np.testing.assert_array_equal(data.variance, arrays["variance"])
    assert data.sample_time == 0.5


@pytest.mark.parametrize("kind", ["csv", "npz", "mat"])
@pytest.mark.parametrize("shape", [(9, 2, 3), (9, 1, 2), (9, 2, 1), (2, 2, 2), (1, 2, 2)])
def test_a_response_with_several_channels_comes_back_exactly(kind: str, shape: tuple[int, int, int]) -> None:
    generator = np.random.default_rng(1)
    arrays = {
        "frequenciesRadPerSecond": np.linspace(0.1, 2.0, shape[0]),
        "response": generator.normal(size=shape) + 1j * generator.normal(size=shape),
        "variance": generator.uniform(1, 2, size=shape),
    }
    stated = Statements((1.0,), channels=shape[1:])
    data = read_measurement(arrays_file(arrays, kind), kind, stated)
    assert isinstance(data, FrequencyResponse)
    np.testing.assert_array_equal(data.response, arrays["response"])
    np.testing.assert_array_equal(data.variance, arrays["variance"])


def test_matlab_keeps_no_last_axis_of_one_and_puts_frequencies_last() -> None:
    response = np.random.default_rng(3).normal(size=(7, 3, 1)) * (1 + 2j)
    stated = Statements((1.0,), channels=(3, 1))
    for array in (response[:, :, 0], np.moveaxis(response, 0, 2)):
        data = read_measurement(
            matlab(True, w=np.arange(1.0, 8.0), response=array, other=np.ones((2, 2))), "mat", stated
        )
        assert isinstance(data, FrequencyResponse)
        np.testing.assert_array_equal(data.response, response)


@pytest.mark.parametrize(
    "header",
    [
        "w,re_y1_u1,im_y1_u1,re_y1_u1 ",
        "w,re_y1_u2,im_y1_u2,x",
        "w,re_y1_u1,im_y1_u1,responseRe",
        "w,re_y0_u1,im_y0_u1,x",
    ],
)
def test_columns_that_leave_entries_open_or_double_are_refused(header: str) -> None:
    with pytest.raises(FileError):
        read_measurement(f"{header}\n1,2,3,4\n".encode(), "csv", POINT)


@pytest.mark.parametrize("compressed", [False, True])
def test_files_of_other_programs_are_read(compressed: bool) -> None:
    generator = np.random.default_rng(2)
    u, y = generator.normal(size=30), generator.normal(size=30).astype(np.float32)
    response = generator.normal(size=4) + 1j * generator.normal(size=4)
    content = matlab(compressed, u=u, y=y, Ts=0.1, period=15, note="text", data={"w": np.arange(4.0), "G": response})
    record = read_measurement(content, "mat", POINT)
    assert isinstance(record, TimeRecord)
    np.testing.assert_array_equal(record.input, u)
    np.testing.assert_array_equal(record.output, y)
    assert (record.sample_time, record.period) == (0.1, 15)
    inside = read_measurement(content, "mat", Statements((1.0,), group="data"))
    assert isinstance(inside, FrequencyResponse)
    np.testing.assert_array_equal(inside.response, response)
    with pytest.raises(FileError, match="data"):
        read_measurement(content, "mat", Statements((1.0,), group="nothing"))


def test_what_is_written_is_read_by_other_programs() -> None:
    arrays = {"input": np.arange(5.0), "response": np.arange(3) * 1j, "covariance": np.arange(6.0).reshape(2, 3)}
    read = scipy.io.loadmat(io.BytesIO(mat_writer.write(arrays)))
    np.testing.assert_array_equal(read["input"][:, 0], arrays["input"])
    np.testing.assert_array_equal(read["response"][:, 0], arrays["response"])
    np.testing.assert_array_equal(read["covariance"], arrays["covariance"])
    signal = np.array([0.5, -2.0, 1.0])
    rate, samples = wavfile.read(io.BytesIO(wav_file.write(signal, 0.001)))
    assert rate == 1000
    np.testing.assert_allclose(2.0 * samples, signal, rtol=1e-7)
    with np.load(io.BytesIO(npz_writer.write(arrays)), allow_pickle=False) as archive:
        assert set(archive.files) == set(arrays)


@pytest.mark.parametrize("text", ["t;u;y\n0;1;2\n0.5;3;4\n", "\ufeffTime,Input,OUTPUT\r\n0,1,2\r\n0.5,3,4\r\n"])
def test_spreadsheets_differ(text: str) -> None:
    record = read_measurement(text.encode(), "csv", POINT)
    assert isinstance(record, TimeRecord)
    assert record.sample_time == 0.5
    assert record.output.tolist() == [2.0, 4.0]


def test_frequencies_in_hertz_become_radians() -> None:
    data = read_measurement(b"freq_Hz,Zre_ohm,Zim_ohm,active\n1,2,3,1\n2,4,5,1\n", "csv", POINT)
    assert isinstance(data, FrequencyResponse)
    np.testing.assert_allclose(data.frequencies, [2 * np.pi, 4 * np.pi])
    assert data.response.tolist() == [2 + 3j, 4 + 5j]
    assert data.sample_time is None


def test_what_is_stated_goes_before_the_file_but_not_against_it() -> None:
    table = from_arrays({"input": np.ones(4), "output": np.arange(4.0), "time": np.arange(4) * 0.1})
    assert measurement(table, Statements((1.0,), sample_time=0.10001)).measurement.sample_time == 0.10001
    with pytest.raises(FileError, match=r"0\.2"):
        measurement(table, Statements((1.0,), sample_time=0.2))
    without = from_arrays({"input": np.ones(4), "output": np.arange(4.0)})
    with pytest.raises(FileError, match="sampleTimeSeconds"):
        measurement(without, POINT)


@pytest.mark.parametrize("name", [n for n in BAD_FILES if n != "csv of zeros"])
def test_bad_files_are_refused_with_a_reason(name: str) -> None:
    file_name, content = BAD_FILES[name]
    with pytest.raises(MisuseError, match=r"\w+ \w+"):
        read_measurement(content, file_name.rpartition(".")[2], POINT)


@pytest.mark.parametrize("kind", ["csv", "npz", "mat", "matlab"])
@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    changes=st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(0, 255)), max_size=8), end=st.floats(0, 1)
)
def test_damage_ends_in_a_file_error_or_in_numbers(kind: str, changes: list[tuple[float, int]], end: float) -> None:
    good = matlab(True, u=ARRAYS["input"], y=ARRAYS["output"], Ts=1.0) if kind == "matlab" else WRITERS[kind](ARRAYS)
    content = bytearray(good if end > 0.5 else good[: int(2 * end * len(good))])
    for where, value in changes:
        if content:
            content[int(where * len(content))] = value
    try:
        data = read_measurement(bytes(content), "mat" if kind == "matlab" else kind, POINT)
    except MisuseError:
        return
    assert np.isfinite(data.input).all() if isinstance(data, TimeRecord) else np.isfinite(data.response).all()


def test_mat_elements_cannot_be_deeper_than_they_claim() -> None:
    inner = b""
    for _ in range(40):
        inner = struct.pack("<II", 14, len(inner)) + inner
    with pytest.raises(FileError):
        MatlabFile.read(mat_writer.HEADER + inner)


def test_wav_says_what_full_scale_is() -> None:
    signal = 3.25 * np.sin(np.arange(501))
    content = wav_file.write(signal, 0.001)
    start = content.index(b"ICMT") + 8
    comment = content[start : content.index(b"\0", start)].decode("ascii")
    scale = float(comment.split(" is ")[1].split()[0])
    assert scale * wavfile.read(io.BytesIO(content))[1] == pytest.approx(signal, rel=1e-6, abs=1e-6)


def test_wav_needs_a_whole_rate() -> None:
    with pytest.raises(RangeError, match="another format"):
        wav_file.write(np.ones(4), 0.3)
