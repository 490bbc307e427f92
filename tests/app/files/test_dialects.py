"""Texts as instruments write them: all mixes of separator, decimal mark, encoding, unit and sign give one response."""

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from app.files.contents import FileError
from app.files.measurement import Reading, Statements, read_measurements
from app.files.statements import Signal
from identification.signals import FrequencyResponse, TimeRecord

F = np.logspace(-1, 3, 23)
Z = 0.02 + 0.05 / (1 + 0.5j * 2 * np.pi * F)
POINT = Statements((1.0,))
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "blanks": "  ", "comma and blank": ", "}
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1", "cp1252")
STYLES: dict[str, Callable[[str, str], str]] = {
    "brackets": lambda name, unit: f"{name}[{unit}]",
    "parentheses": lambda name, unit: f"{name}({unit})",
    "stroke": lambda name, unit: f"{name}/{unit}",
    "underscore": lambda name, unit: f"{name}_{unit}",
}


def written(value: float, mark: str) -> str:
    return repr(float(value)).replace(".", mark)


def response(content: bytes | str, **stated: object) -> FrequencyResponse:
    found = reading(content, **stated).measurement
    assert isinstance(found, FrequencyResponse)
    return found


def record(content: bytes | str, **stated: object) -> TimeRecord:
    found = reading(content, **stated).measurement
    assert isinstance(found, TimeRecord)
    return found


def reading(content: bytes | str, **stated: object) -> Reading:
    data = content if isinstance(content, bytes) else content.encode()
    return read_measurements(data, "csv", Statements((1.0,), **stated))[0]  # type: ignore[arg-type]


def table(header: str, *columns: np.ndarray, separator: str = ",", mark: str = ".") -> str:
    rows = [separator.join(written(value, mark) for value in row) for row in zip(*columns, strict=True)]
    return "\n".join([header, *rows]) + "\n"


MIXES = [
    mix
    for mix in itertools.product(SEPARATORS, (".", ","), ENCODINGS, STYLES, (1, -1))
    if not (SEPARATORS[mix[0]].strip() == mix[1] == ",")
]


@pytest.mark.parametrize("separator", SEPARATORS)
@pytest.mark.parametrize("style", STYLES)
def test_every_mix_gives_the_same_response(separator: str, style: str) -> None:
    mixes = [mix for mix in MIXES if mix[0] == separator and mix[3] == style]
    assert len(mixes) >= 12
    for _, mark, encoding, _, sign in mixes:
        between, named = SEPARATORS[separator], STYLES[style]
        names = [named("Freq", "kHz"), named("Zre", "mOhm"), ("-" if sign < 0 else "") + named("Zim", "mOhm")]
        text = table(between.join(names), F / 1e3, 1e3 * Z.real, sign * 1e3 * Z.imag, separator=between, mark=mark)
        found = response(text.encode(encoding), inputs=(Signal("I", "A"),), outputs=(Signal("U", "V"),))
        np.testing.assert_allclose(found.frequencies, 2 * np.pi * F, rtol=1e-12)
        np.testing.assert_allclose(found.response, Z, rtol=1e-12, err_msg=f"{mark} {encoding} {sign}")


@pytest.mark.parametrize(
    "names",
    [
        ("Frequency (Hz)", "Re(Z)/Ohm", "-Im(Z)/Ohm"),
        ("freq / Hz", "Z' / ohm", "-Z'' / ohm"),
        ("Freq(Hz)", "Z'(a)", "-Z''(b)"),
        ("Frequency [Hz]", "Z' (Ω)", "−Z'' (Ω)"),
        ("freq_hz", "Z_real", "neg. Z_imag"),
        ("f, Hz", "real(Z)", "(-imag(Z))"),
        ("Frequenz in Hz", "Realteil", "-Imaginärteil"),
        ("omega [rad/s]", "Re{Z}", "minus Im{Z}"),
        ("Kreisfrequenz [1/s]", "ZReal", "ZImag*(-1)"),
    ],
)
def test_names_of_real_and_minus_imaginary_parts(names: tuple[str, str, str]) -> None:
    scale = 2 * np.pi if names[0].startswith(("omega", "Kreis")) else 1.0
    found = response(table(";".join(names), scale * F, Z.real, -Z.imag, separator=";"))
    np.testing.assert_allclose(found.frequencies, 2 * np.pi * F, rtol=1e-12)
    np.testing.assert_allclose(found.response, Z, rtol=1e-12)


@pytest.mark.parametrize("name", ["Frequency", "freq", "f", "Freqs", "frecuencia", "Frequenz", "fréquence"])
def test_a_frequency_without_unit_is_a_question_with_two_answers(name: str) -> None:
    text = table(f"{name},re,im", F, Z.real, Z.imag)
    with pytest.raises(FileError, match=f"units {name}=Hz or {name}=rad/s") as asked:
        response(text)
    assert asked.value.field == "/units"
    np.testing.assert_allclose(response(text, units=(f"{name}=Hz",)).frequencies, 2 * np.pi * F)
    np.testing.assert_allclose(response(text, units=(f"{name}=rad/s",)).frequencies, F)
    np.testing.assert_allclose(response(text, columns=(f"frequencyHz={name}",)).frequencies, 2 * np.pi * F)


MAGNITUDES = {
    "Magnitude (dB)": 20 * np.log10(abs(Z)),
    "mag_db": 20 * np.log10(abs(Z)),
    "dB(Z)": 20 * np.log10(abs(Z)),
    "Magnitude": 20 * np.log10(abs(Z)),  # negative, so it can be nothing else
    "|Z|": abs(Z),
    "|Z|/Ohm": abs(Z),
    "Z": abs(Z),
    "Zmod (mOhm)": 1e3 * abs(Z),
}
PHASES = {
    "Phase (deg)": np.degrees(np.angle(Z)),
    "-Phase (°)": -np.degrees(np.angle(Z)),
    "neg. Phase / °": -np.degrees(np.angle(Z)),
    "phase [rad]": np.angle(Z),
    "Phase(Z)/deg": np.degrees(np.angle(Z)),
    "arg(Z) (mrad)": 1e3 * np.angle(Z),
}


@pytest.mark.parametrize(("size", "angle"), itertools.product(MAGNITUDES, PHASES))
def test_magnitude_and_phase(size: str, angle: str) -> None:
    text = table(f"freq (Hz);{size};{angle}", F, MAGNITUDES[size], PHASES[angle], separator=";")
    found = response(text, inputs=(Signal("", "A"),), outputs=(Signal("", "V"),))
    np.testing.assert_allclose(found.response, Z, rtol=1e-12)


@pytest.mark.parametrize(
    ("header", "columns", "question"),
    [
        ("freq (Hz),gain,phase (deg)", (abs(Z), np.degrees(np.angle(Z))), "gain=dB, or gain=1"),
        ("freq (Hz),|Z|,phase", (abs(Z), np.angle(Z)), "phase=deg or phase=rad"),
        ("freq (Hz),|Z|", (abs(Z),), "no phase"),
        ("freq (Hz),response", (abs(Z),), "phase"),
        ("freq (Hz),re", (Z.real,), "imaginary"),
        ("freq (Hz),im", (Z.imag,), "real"),
        ("freq (Hz),re a,im a,re b,im b", (Z.real, Z.imag, Z.real, 2 * Z.imag), "mean the same"),
        ("freq (N),re,im", (Z.real, Z.imag), "understood"),
    ],
)
def test_what_cannot_be_known_is_asked(header: str, columns: tuple[np.ndarray, ...], question: str) -> None:
    with pytest.raises(FileError, match=question):
        response(table(header, F, *columns))


@pytest.mark.parametrize("unit", ["j", "i", "J", "I"])
@pytest.mark.parametrize("mark", [".", ","])
@pytest.mark.parametrize(
    "form", ["{re}{im:s}{unit}", "({re}{im:s}{unit})", "{re} {sign} {size}{unit}", "{re}{sign}{unit}{size}"]
)
def test_complex_numbers_in_cells(unit: str, mark: str, form: str) -> None:
    def cell(value: complex) -> str:
        size = repr(abs(float(value.imag)))
        sign = "-" if value.imag < 0 else "+"
        text = form.format(re=repr(float(value.real)), im=sign + size, sign=sign, size=size, unit=unit)
        return text.replace(".", mark)

    rows = "\n".join(f"{written(f, mark)};{cell(z)}" for f, z in zip(F, Z, strict=True))
    np.testing.assert_allclose(response(f"f (Hz);Z\n{rows}\n").response, Z, rtol=1e-12)


def test_comments_units_in_a_line_gaps_and_footers() -> None:
    body = table("x", F, Z.real, Z.imag).split("\n", 1)[1]
    for above in (
        "# instrument 3\n# 2024-01-01 12:00\nfreq_hz,re,im\n",
        "Report 7\nOperator: N.N., Gain 3\n\nfreq,re,im\n(Hz),(Ohm),(Ohm)\n",
        "% freq/Hz re im\n",
        "freq,re,im\nHz,,\n",
    ):
        np.testing.assert_array_equal(response(above + body + "# end\nEnd of file\n").response, Z)
    lines = body.splitlines()
    lines[3] = f"{float(F[3])!r},,{float(Z.imag[3])!r}"
    found = reading("f [Hz],re,im\n" + "\n".join(lines))
    assert isinstance(found.measurement, FrequencyResponse)
    np.testing.assert_array_equal(found.measurement.response, np.delete(Z, 3))
    assert "line 4 of the data" in found.notes[0]


T = np.arange(60) * 1e-3
U, Y = np.sign(np.sin(0.4 * np.arange(60) + 0.1)), np.cos(0.3 * np.arange(60))


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("t (s)", T + 17.25),
        ("t(s)", T),
        ("Time [ms]", 1e3 * T),
        ("Zeit in µs", 1e6 * T),
        ("time/us", 1e6 * T),
        ("time_ms", 1e3 * T),
        ("Time (h)", T / 3600),
        ("t", T.astype(np.float32).astype(float)),
    ],
)
def test_times_in_all_units(name: str, values: np.ndarray) -> None:
    found = record(table(f"{name};u;y", values, U, Y, separator=";", mark=","))
    assert found.sample_time == pytest.approx(1e-3, rel=1e-9)
    np.testing.assert_array_equal(found.input, U)


def test_counted_times_need_the_sample_time_and_take_it() -> None:
    text = table("t,u,y", np.arange(60.0), U, Y)
    assert record(text, sample_time=2e-3).sample_time == 2e-3
    assert record(table("n,u,y", np.arange(60.0), U, Y), sample_time=2e-3).sample_time == 2e-3
    with pytest.raises(FileError, match="state sampleTimeSeconds"):
        record(table("n,u,y", np.arange(60.0), U, Y))
    assert record("Sampling rate: 500 Hz\n" + table("n,u,y", np.arange(60.0), U, Y)).sample_time == 2e-3
    assert record("# dt = 2 ms\n" + table("u,y", U, Y)).sample_time == 2e-3
    with pytest.raises(FileError, match=r"every 0\.001 s, but"):
        record(table("t (s),u,y", T, U, Y), sample_time=2e-3)


def test_clock_times_are_times() -> None:
    stamps = [f"2024-03-01 23:59:{59 + k * 0.01:06.3f}" for k in range(60)]
    rows = "\n".join(f"{s};{u};{y}" for s, u, y in zip(stamps, U, Y, strict=True))
    assert record(f"Timestamp;u;y\n{rows}\n").sample_time == pytest.approx(0.01)


def test_a_motor_current_is_no_imaginary_part() -> None:
    plant = {"inputs": (Signal("voltage", "V"),), "outputs": (Signal("motor current", "A"),)}
    for header in ("t (s);u;Im", "t (s);Um (V);Im (mA)", "time;voltage;Im [mA]"):
        scale = 1e3 if "mA" in header else 1.0
        found = record(table(header, T, U, scale * Y, separator=";"), **plant)
        np.testing.assert_allclose(found.output, Y, rtol=1e-12)
        np.testing.assert_array_equal(found.input, U)
    found = record(table("t;u;Im", T, Y, U, separator=";"), inputs=(Signal("Im", "A"),), outputs=(Signal("u", "V"),))
    np.testing.assert_array_equal(found.input, U)
    np.testing.assert_array_equal(found.output, Y)


def test_signs_and_units_of_signals() -> None:
    plant = {"inputs": (Signal("force", "N"),), "outputs": (Signal("way", "m"),)}
    found = record(table("t [s],-u [kN],y [mm]", T, U, Y), **plant)
    np.testing.assert_allclose(found.input, -1e3 * U)
    np.testing.assert_allclose(found.output, 1e-3 * Y)
    stated = record(table("t [s],F [kN],x [mm]", T, U, Y), columns=("-input=F [kN]", "output=x [mm]"), **plant)
    np.testing.assert_allclose(stated.input, -1e3 * U)
    once = record(table("t,-u,y", T, U, Y), columns=("-input=-u",))
    np.testing.assert_array_equal(once.input, -U)
    with pytest.raises(FileError, match="another quantity"):
        record(table("t,u [A],y [mm]", T, U, Y), **plant)


def test_without_header_columns_are_chosen_by_number() -> None:
    text = table("", T, U, Y).lstrip()
    with pytest.raises(FileError, match="column 1, column 2, column 3"):
        record(text)
    found = record(text, columns=("time=column 1", "input=column 2", "output=column 3"))
    np.testing.assert_array_equal(found.output, Y)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("t,u,y\n0,1,2\n1,one,3\n2,1,1\n", "'one' where a number"),
        ("t,u,y\n0,1,2\n1,2\n2,1,1\n", "line 3 has 2 values, line 2 has 3"),
        ("a,b\n0,1,2\n1,2,3\n", "header has 2 names, the lines have 3"),
        ("u,u,y\n0,1,2\n1,2,3\n", "same name"),
        ("nothing here\n", "no line has two numbers"),
        ("", "empty"),
    ],
)
def test_what_is_no_table_says_where(content: str, message: str) -> None:
    with pytest.raises(FileError, match=message):
        reading(content)
