"""Files as instruments and programs write them, made here byte by byte: each read alone or with one choice."""

import io
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
import pyarrow as pa
import pytest
import scipy.io
from openpyxl import Workbook
from pyarrow import feather, parquet

from app.files.contents import FileError
from app.files.measurement import Statements, read_measurements
from app.files.readers import kind_of_file
from app.files.statements import Signal
from identification.signals import FrequencyResponse, TimeRecord

F = np.logspace(-1, 3, 31)
W = 2 * np.pi * F
Z = 0.02 + 0.05 / (1 + 0.5j * W)
N = 80
T = 0.005 * np.arange(N)
U = np.sign(np.sin(0.4 * np.arange(N) + 0.1))
Y = np.cos(0.3 * np.arange(N)) * 0.01
PLANT = {"inputs": (Signal("current", "A"),), "outputs": (Signal("voltage", "V"),)}


@dataclass(frozen=True)
class File:
    """A file by name and bytes, and what is stated beside it."""

    name: str
    content: bytes
    stated: dict[str, Any]


def text(name: str, lines: list[str], encoding: str = "utf-8", end: str = "\n", **stated: Any) -> File:
    return File(name, end.join([*lines, ""]).encode(encoding), stated)


def rows(*columns: np.ndarray, separator: str = "\t", form: str = ".12g", mark: str = ".") -> list[str]:
    return [separator.join(f"{v:{form}}".replace(".", mark) for v in row) for row in zip(*columns, strict=True)]


def bode(frequencies: np.ndarray, unit: str = "deg") -> list[str]:
    angle = np.angle(Z) if unit == "rad" else np.degrees(np.angle(Z))
    return rows(frequencies, 20 * np.log10(abs(Z)), angle, separator=",")


def matlab(name: str = "a.mat", stated: dict[str, Any] | None = None, **variables: Any) -> File:
    buffer = io.BytesIO()
    scipy.io.savemat(buffer, variables, do_compression=True)
    return File(name, buffer.getvalue(), stated or {})


def structures(*ones: dict[str, Any]) -> np.ndarray:
    """An array of structures as scipy writes it."""
    made = np.zeros((1, len(ones)), dtype=[(name, "O") for name in ones[0]])
    for i, one in enumerate(ones):
        for name, value in one.items():
            made[0, i][name] = value
    return made


def cells(*values: Any) -> np.ndarray:
    made = np.empty((1, len(values)), dtype=object)
    for i, value in enumerate(values):
        made[0, i] = value
    return made


def hdf5(fill: Callable[[Any], None], userblock: bytes = b"") -> bytes:
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", userblock_size=512 if userblock else 0) as file:
        fill(file)
    content = buffer.getvalue()
    return userblock.ljust(512, b"\0") + content[512:] if userblock else content


def matlab_73(fill: Callable[[Any], None]) -> bytes:
    return hdf5(fill, b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM")


def workbook(*lines: list[Any], title: str = "Tabelle1", more: str | None = None) -> bytes:
    book = Workbook()
    sheet = book.active
    sheet.title = title
    for line in lines:
        sheet.append(line)
    if more:
        book.create_sheet(more).append(["only", "words"])
    buffer = io.BytesIO()
    book.save(buffer)
    return buffer.getvalue()


def written(write: Callable[..., None], table: Any) -> bytes:
    buffer = io.BytesIO()
    write(table, buffer)
    return buffer.getvalue()


def _structure_73(file: Any) -> None:
    group = file.create_group("run").create_group("measured")
    for name, values in (("t", T), ("u", U), ("y", Y)):
        group[name] = values[None, :]


def _complex_73(file: Any) -> None:
    kind = np.dtype([("real", "f8"), ("imag", "f8")])
    values = np.zeros((1, len(Z)), dtype=kind)
    values["real"], values["imag"] = Z.real, Z.imag
    file["G"], file["w"] = values, W[None, :]


DSPACE = {
    "X": structures({"Name": "", "Data": T[None, :], "Unit": "s"}),
    "Y": structures(
        {"Name": "Model Root/Plant/current", "Data": U[None, :] * 1e3, "Unit": "mA"},
        {"Name": "Model Root/Plant/voltage", "Data": Y[None, :], "Unit": "V"},
    ),
    "Description": "a recorder",
}
LABELS = np.repeat(np.arange(1.0, 4.0), len(F))
NOISE = np.random.default_rng(3).normal(size=(3, len(F))) * 1e-4
ZPRIME = ["  Freq(Hz)", "Ampl", "Bias", "Time(Sec)", "Z'(a)", "Z''(b)", "GD", "Err", "Range"]
ZERO = np.zeros(len(F))

RESPONSES: dict[str, File] = {
    "gamry dta": text(
        "a.DTA",
        [
            *("EXPLAIN", "TAG\tEISPOT", "VDC\tPOTEN\t0.0E+000\tT\tDC &Voltage (V)", "OCVCURVE\tTABLE\t2"),
            *("\tPt\tT\tVf\tVm\tAch", "\t#\ts\tV\tV\tV", "\t0\t0.5\t3.6\t0\t0", "\t1\t1.0\t3.6\t0\t0"),
            *("ZCURVE\tTABLE", "\tPt\tTime\tFreq\tZreal\tZimag\tZsig\tZmod\tZphz\tIERange"),
            "\t#\ts\tHz\tohm\tohm\tV\tohm\t°\t#",
            *(
                f"\t{row}"
                for row in rows(np.arange(31.0), ZERO + 1, F, Z.real, Z.imag, ZERO + 1, abs(Z), ZERO, ZERO + 9)
            ),
        ],
        "latin-1",
    ),
    "ec-lab with decimal comma": text(
        "a.mpt",
        [
            *(
                "EC-Lab ASCII FILE",
                "Nb header lines : 6",
                "Ewe ctrl range : min = -2,50 V, max = 2,50 V",
                "",
                "Comments :",
            ),
            "freq/Hz\tRe(Z)/Ohm\t-Im(Z)/Ohm\t|Z|/Ohm\tPhase(Z)/deg\ttime/s\t<I>/mA\t",
            *rows(F, Z.real, -Z.imag, abs(Z), np.degrees(np.angle(Z)), F * 0, F * 0 + 1.5, mark=","),
        ],
        "latin-1",
        "\r\n",
    ),
    "zview": text(
        "a.z",
        [
            "ZPLOT2 ASCII",
            "",
            "\t".join(ZPRIME),
            "End Comments",
            *rows(F, ZERO, ZERO, ZERO, Z.real, Z.imag, ZERO, ZERO, ZERO),
        ],
        "latin-1",
        "\r\n",
    ),
    "zahner": text(
        "a.txt",
        [
            *("Zahner Analysis", "", "  Number   Frequency/Hz   Impedance/Ohm   Phase/deg   Significance"),
            *rows(np.arange(31.0), F, abs(Z), np.degrees(np.angle(Z)), ZERO + 0.99, separator="   "),
        ],
    ),
    "autolab": text(
        "a.txt",
        [
            "Index;Frequency (Hz);Z' (Ω);-Z'' (Ω);Z (Ω);-Phase (°);Time (s)",
            *rows(np.arange(31.0), F, Z.real, -Z.imag, abs(Z), -np.degrees(np.angle(Z)), ZERO, separator=";"),
        ],
    ),
    "palmsens": text(
        "a.csv",
        [
            *("Date and time:,2024-03-01 12:00:00", "Notes:", "", "an example,,,,,"),
            "freq / Hz,neg. Phase / °,Idc / uA,Z / ohm,Z' / ohm,-Z'' / ohm,Cs / F",
            *rows(F, -np.degrees(np.angle(Z)), ZERO, abs(Z), Z.real, -Z.imag, ZERO, separator=","),
        ],
        "utf-16",
        "\r\n",
    ),
    "analyser in dB and degrees": text(
        "bode.csv",
        ["Model,BodeAnalyser", "Points,31", "", "Frequency (Hz),Gain (dB),Phase (deg)", *bode(F)],
    ),
    "oscilloscope's sweep in kHz": text("a.csv", ["Frequency in kHz,Amplitude in dB,Phase in °", *bode(F / 1e3)]),
    "complex cells": text(
        "a.csv",
        ["frequency_Hz;Z", *(f"{f!r};{z.real!r}{z.imag:+.17g}i" for f, z in zip(F.tolist(), Z.tolist(), strict=True))],
    ),
    "numpy savetxt": text(
        "a.dat", ["# f/Hz Re(Z)/mOhm Im(Z)/mOhm", *rows(F, 1e3 * Z.real, 1e3 * Z.imag, separator=" ", form=".18e")]
    ),
    "bare frequency with one choice": text(
        "a.csv", ["Frequency,Zre,Zim", *rows(F, Z.real, Z.imag, separator=",")], units=("Frequency=Hz",)
    ),
    "no header with one choice each": text(
        "a.txt",
        rows(F, Z.real, Z.imag, separator=" "),
        columns=("frequencyHz=column 1", "responseRe=column 2", "responseIm=column 3"),
    ),
    "several spectra, one chosen": text(
        "a.csv",
        [
            "run;freq_hz;re;im",
            *rows(LABELS, np.tile(F, 3), np.tile(Z.real, 3) * LABELS, np.tile(Z.imag, 3) * LABELS, separator=";"),
        ],
        rows=("run=1",),
    ),
    "matlab vectors": matlab(w=W, G=Z),
    "matlab with Ts = 0": matlab(w=W, G=Z, Ts=0.0),
    "matlab nested": matlab(
        stated={"group": "cell.eis"}, cell={"eis": {"freq_Hz": F, "Zreal": Z.real, "Zimag": Z.imag}, "note": "x"}
    ),
    "matlab nested, found alone": matlab(cell={"eis": {"omega": W, "Z": Z}, "note": "x", "list": cells("a", "b")}),
    "idfrd as structure": matlab(
        G={"ResponseData": Z[None, None, :], "Frequency": F[:, None], "FrequencyUnit": "Hz", "Ts": 0.0}
    ),
    "frd as structure": matlab(
        sys={"Frequency": W[:, None], "ResponseData": Z[None, None, :], "Units": "rad/s", "Ts": 0.0}
    ),
    "matlab 7.3 complex": File("a.mat", matlab_73(_complex_73), {}),
    "excel": File(
        "a.xlsx",
        workbook(
            ["Report", None],
            [],
            ["Frequency (Hz)", "Z' (mΩ)", "-Z'' (mΩ)"],
            *np.column_stack([F, 1e3 * Z.real, -1e3 * Z.imag]).tolist(),
            more="Notes",
        ),
        {},
    ),
    "parquet": File(
        "a.parquet",
        written(lambda t, b: parquet.write_table(t, b), pa.table({"freq_hz": F, "re": Z.real, "im": Z.imag})),
        {},
    ),
    "hdf5 complex": File(
        "a.h5", hdf5(lambda f: (f.create_dataset("omega", data=W), f.create_dataset("G", data=Z))), {}
    ),  # type: ignore[arg-type]
    "touchstone": text(
        "a.s1p", ["! made here", "# kHz S RI R 50", *rows(F / 1e3, Z.real, Z.imag, separator=" ", form=".15g")]
    ),
    "touchstone of two ports, one chosen": text(
        "a.s2p",
        ["# Hz S RI R 50", *rows(F, *(part for k in (3, 1, 2, 4) for part in (k * Z.real, k * Z.imag)), separator=" ")],
        group="S21",
    ),
    "universal file 58": text(
        "a.uff",
        [
            *("    -1", "    58", "made here", "NONE", "01-Jan-24 12:00:00", "NONE", "NONE"),
            "    4         0    0         0 NONE               1   3 NONE               1   3",
            f"{6:10d}{len(F):10d}{0:10d}{0.0:13.5e}{0.0:13.5e}{0.0:13.5e}",
            *(
                f"{kind:10d}{0:5d}{0:5d}{0:5d} {label:20s} {unit:20s}"
                for kind, label, unit in (
                    (18, "Frequency", "Hz"),
                    (8, "Voltage", "V"),
                    (13, "Current", "A"),
                    (0, "NONE", "NONE"),
                )
            ),
            *(f"{f:13.5e}{z.real:20.12e}{z.imag:20.12e}" for f, z in zip(F, Z, strict=True)),
            "    -1",
        ],
    ),
}

RECORDS: dict[str, File] = {
    "german logger": text(
        "a.csv",
        ["Zeit [ms];Strom [mA];Spannung [mV]", *rows(1e3 * T, 1e3 * U, 1e3 * Y, separator=";", mark=",")],
        "cp1252",
        "\r\n",
    ),
    "picoscope": text(
        "a.csv", ["Time,Channel A,Channel B", "(ms),(A),(mV)", "", *rows(1e3 * T, U, 1e3 * Y, separator=",")]
    ),
    "oscilloscope with preamble": text(
        "a.csv",
        [
            "Model,MSO",
            "Sample Interval,5.0E-03",
            "Horizontal Units,S",
            "",
            "TIME,u,y",
            *rows(T - 0.1, U, Y, separator=","),
        ],
    ),
    "signs": text("a.txt", ["t(s)\t-u\t-y", *rows(T, -U, -Y)]),
    "counted, with the rate above": text(
        "a.asc", ["% fs = 200 Hz", "% n u y", *rows(np.arange(float(N)), U, Y, separator="  ")]
    ),
    "float32 and rounded": text(
        "a.csv", ["t,u,y", *rows((37.0 + T).astype(np.float32).astype(float), U, Y, separator=",", form=".9g")]
    ),
    "matlab matrix with one choice each": matlab(
        data=np.column_stack([T, U, Y]), stated={"columns": ("time=data(:,1)", "input=data(:,2)", "output=data(:,3)")}
    ),
    "dspace": matlab(exp001=DSPACE),
    "iddata as structure": matlab(
        z={"OutputData": Y[:, None], "InputData": U[:, None], "Ts": 5.0, "TimeUnit": "milliseconds"}
    ),
    "iddata with cells": matlab(
        z={"OutputData": cells(Y[:, None]), "InputData": cells(U[:, None]), "Ts": cells(0.005)}
    ),
    "simulink": matlab(
        out={
            "time": T[:, None],
            "signals": structures({"values": U[:, None], "label": "u"}, {"values": Y[:, None], "label": "y"}),
        }
    ),
    "matlab array of structures, one chosen": matlab(
        run=structures({"t": T, "u": -U, "y": Y}, {"t": T, "u": U, "y": Y}), stated={"group": "run(2)"}
    ),
    "matlab 7.3 nested": File("a.mat", matlab_73(_structure_73), {}),
    "excel": File(
        "a.xlsx", workbook(["Time (ms)", "u", "y (mV)"], *np.column_stack([1e3 * T, U, 1e3 * Y]).tolist()), {}
    ),
    "parquet with datetimes": File(
        "a.parquet",
        written(
            lambda t, b: parquet.write_table(t, b),
            pa.table(
                {"timestamp": pa.array((T * 1e6).round().astype("int64") + 10**15, pa.timestamp("us")), "u": U, "y": Y}
            ),
        ),
        {},
    ),
    "feather": File(
        "a.feather",
        written(
            lambda t, b: feather.write_feather(t, b),
            pa.table({"t (s)": T, "u [A]": U.astype(np.float32), "y [mV]": 1e3 * Y}),
        ),
        {},
    ),
    "npz float32": File(
        "a.npz", (lambda b: (np.savez(b, t=T.astype(np.float32), u=U, y=Y), b.getvalue())[1])(io.BytesIO()), {}
    ),
}


def read(file: File) -> Any:
    kind = kind_of_file(file.name, file.content)
    assert kind is not None
    stated = Statements((1.0,), **{**PLANT, **file.stated})  # type: ignore[arg-type]
    (found,) = read_measurements(file.content, kind, stated)
    return found.measurement


def test_there_are_forty() -> None:
    assert len(RESPONSES) + len(RECORDS) >= 40


@pytest.mark.parametrize("name", RESPONSES)
def test_responses(name: str) -> None:
    data = read(RESPONSES[name])
    assert isinstance(data, FrequencyResponse)
    assert data.sample_time is None
    digits = 1e-5 if "universal" in name else 1e-9
    np.testing.assert_allclose(data.frequencies, W, rtol=digits)
    np.testing.assert_allclose(data.response, Z, rtol=1e-6 if "universal" in name else 1e-9)


@pytest.mark.parametrize("name", RECORDS)
def test_records(name: str) -> None:
    data = read(RECORDS[name])
    assert isinstance(data, TimeRecord)
    assert data.sample_time == pytest.approx(0.005, rel=1e-9)
    np.testing.assert_allclose(data.input, U, rtol=1e-9)
    np.testing.assert_allclose(data.output, Y, rtol=1e-6, atol=1e-12)


WRONG: dict[str, tuple[File, str]] = {
    "a signal to be played": (matlab(t=T, u=U), "input but no output"),
    "objects": (matlab(note="only words"), "struct"),
    "several structures": (matlab(a={"t": T, "u": U, "y": Y}, b={"t": T, "u": U, "y": Y}), "several tables.*'a', 'b'"),
    "several spectra": (
        text(
            "a.csv",
            ["soc;f (Hz);re;im", *rows(LABELS, np.tile(F, 3), np.tile(Z.real, 3), np.tile(Z.imag, 3), separator=";")],
        ),
        "rows, such as soc=1",
    ),
    "bare frequency": (text("a.csv", ["Frequency,re,im", *rows(F, Z.real, Z.imag, separator=",")]), "Frequency=Hz or"),
    "bare phase": (
        text("a.csv", ["f (Hz),|Z|,phase", *rows(F, abs(Z), np.angle(Z), separator=",")]),
        "phase=deg or phase=rad",
    ),
    "missing samples": (
        text("a.csv", ["t,u,y", *rows(np.delete(T, [7, 8]), U[2:], Y[2:], separator=",")]),
        "samples are missing",
    ),
    "jitter": (
        text("a.csv", ["t,u,y", *rows(T + 0.001 * np.sin(9 * np.arange(N)), U, Y, separator=",")]),
        "jitters by",
    ),
    "another quantity": (text("a.csv", ["t,u [mm],y [V]", *rows(T, U, Y, separator=",")]), "another quantity"),
    "words": (File("a.xlsx", workbook(["u", "y"], ["one", "two"]), {}), "no sheet"),
    "a cut workbook": (File("a.xlsx", workbook(["t", "u", "y"], [0, 1, 2], [1, 2, 3])[:900], {}), "whole Excel"),
    "three unnamed channels": (text("a.csv", ["t (s),a,b,c", *rows(T, U, Y, U, separator=",")]), "input=a"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_says_what_to_do(name: str) -> None:
    file, message = WRONG[name]
    with pytest.raises(FileError, match=message):
        read(file)


def test_repeats_become_a_mean_and_its_variance() -> None:
    repeats = Z + NOISE + 1j * NOISE[::-1]
    file = text(
        "a.csv",
        ["sweep;f (Hz);re;im", *rows(LABELS, np.tile(F, 3), repeats.real.ravel(), repeats.imag.ravel(), separator=";")],
        columns=("repeat=sweep",),
    )
    data = read(file)
    np.testing.assert_allclose(data.response, repeats.mean(axis=0), rtol=1e-9)
    np.testing.assert_allclose(data.variance, np.var(repeats, axis=0, ddof=1) / 3, rtol=1e-6)
    assert data.variance_degrees_of_freedom == 2


def test_coherence_with_averages_and_deviations_become_variances() -> None:
    coherence = 0.9 + 0.05 * np.sin(np.arange(31))
    lines = ["f (Hz),re,im,coherence", *rows(F, Z.real, Z.imag, coherence, separator=",")]
    data = read(text("a.csv", lines, averages=16))
    np.testing.assert_allclose(data.variance, abs(Z) ** 2 * (1 - coherence) / (16 * coherence), rtol=1e-6)
    assert data.variance_degrees_of_freedom == 15
    unknown = text("a.csv", lines)
    (found,) = read_measurements(unknown.content, "csv", Statements((1.0,)))
    assert "state averages" in " ".join(found.notes)
    both = text("a.csv", ["f (Hz),re,im,std_re,std_im", *rows(F, Z.real, Z.imag, 0.1 * F, 0.2 * F, separator=",")])
    np.testing.assert_allclose(read(both).variance, 0.05 * F**2, rtol=1e-6)


def test_a_long_table_gives_each_operating_point() -> None:
    scale = np.repeat([1.0, 2.0, 3.0], len(F))
    lines = [
        "soc_pct;freq_hz;re;im",
        *rows(10 * scale, np.tile(F, 3), scale * np.tile(Z.real, 3), scale * np.tile(Z.imag, 3), separator=";"),
    ]
    content = text("a.csv", lines).content
    found = read_measurements(content, "csv", Statements((), point_columns=("soc_pct",)))
    assert [one.measurement.operating_point for one in found] == [(10.0,), (20.0,), (30.0,)]
    for k, one in enumerate(found, 1):
        assert isinstance(one.measurement, FrequencyResponse)
        np.testing.assert_allclose(one.measurement.response, k * Z, rtol=1e-9)
    (chosen,) = read_measurements(content, "csv", Statements((20.0,), variables=("soc",)))
    assert isinstance(chosen.measurement, FrequencyResponse)
    np.testing.assert_allclose(chosen.measurement.response, 2 * Z, rtol=1e-9)
    with pytest.raises(FileError, match="no line of the file is of this operating point"):
        read_measurements(content, "csv", Statements((15.0,), variables=("soc",)))
