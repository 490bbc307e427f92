"""Units as engineers write them: kHz, mA, N·m, m/s², 1/min, µs, °C."""

import re
from dataclasses import dataclass
from math import pi

# Exponents of second, metre, kilogram, ampere, kelvin and radian.
Dimension = tuple[int, int, int, int, int, int]
NONE: Dimension = (0, 0, 0, 0, 0, 0)
PREFIXES = {
    **{"f": 1e-15, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1, "h": 1e2},
    **{"k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9, "T": 1e12},
}


@dataclass(frozen=True)
class Unit:
    """A value x in this unit is factor·x + offset in the base units of its dimension."""

    factor: float
    dimension: Dimension
    offset: float = 0.0


def _unit(factor: float, *exponents: int, offset: float = 0.0) -> Unit:
    s, m, kg, a, k, rad = (*exponents, *NONE[len(exponents) :])
    return Unit(factor, (s, m, kg, a, k, rad), offset)


# Units that take prefixes.
_METRIC = {
    "s": _unit(1, 1),
    "m": _unit(1, 0, 1),
    "g": _unit(1e-3, 0, 0, 1),
    "A": _unit(1, 0, 0, 0, 1),
    "K": _unit(1, 0, 0, 0, 0, 1),
    "rad": _unit(1, 0, 0, 0, 0, 0, 1),
    "Hz": _unit(2 * pi, -1, 0, 0, 0, 0, 1),
    "N": _unit(1, -2, 1, 1),
    "Pa": _unit(1, -2, -1, 1),
    "bar": _unit(1e5, -2, -1, 1),
    "J": _unit(1, -2, 2, 1),
    "W": _unit(1, -3, 2, 1),
    "V": _unit(1, -3, 2, 1, -1),
    "Ω": _unit(1, -3, 2, 1, -2),
    "S": _unit(1, 3, -2, -1, 2),
    "C": _unit(1, 1, 0, 0, 1),
    "F": _unit(1, 4, -2, -1, 2),
    "H": _unit(1, -2, 2, 1, -2),
    "T": _unit(1, -2, 0, 1, -1),
    "Wb": _unit(1, -2, 2, 1, -1),
    "l": _unit(1e-3, 0, 3),
    "L": _unit(1e-3, 0, 3),
}
_PLAIN = {
    "min": _unit(60, 1),
    "h": _unit(3600, 1),
    "°": _unit(pi / 180, 0, 0, 0, 0, 0, 1),
    "rev": _unit(2 * pi, 0, 0, 0, 0, 0, 1),
    "rpm": _unit(2 * pi / 60, -1, 0, 0, 0, 0, 1),
    "°C": _unit(1, 0, 0, 0, 0, 1, offset=273.15),
    "°F": _unit(5 / 9, 0, 0, 0, 0, 1, offset=459.67 * 5 / 9),
    "%": _unit(0.01),
    "1": _unit(1),
    "psi": _unit(6894.757293168, -2, -1, 1),
    "in": _unit(0.0254, 0, 1),
    "t": _unit(1000, 0, 0, 1),
    "grav": _unit(9.80665, -2, 1),
}
# Words and spellings, in lower case, of the symbols above.
_WORDS = {
    **dict.fromkeys(("sec", "secs", "second", "seconds", "sek", "sekunden"), "s"),
    **dict.fromkeys(("msec", "millisecond", "milliseconds", "millis"), "ms"),
    **dict.fromkeys(("usec", "microsecond", "microseconds", "micros"), "us"),
    **dict.fromkeys(("nsec", "nanosecond", "nanoseconds"), "ns"),
    **dict.fromkeys(("minute", "minutes", "mins"), "min"),
    **dict.fromkeys(("hour", "hours", "hr", "hrs"), "h"),
    **dict.fromkeys(("hz", "hertz", "cps", "1/s", "1/sec", "s-1", "s^-1", "s⁻¹"), "Hz"),
    **{"khz": "kHz", "kilohertz": "kHz", "ghz": "GHz", "megahertz": "MHz", "millihertz": "mHz"},
    **dict.fromkeys(("radian", "radians"), "rad"),
    **dict.fromkeys(("radpersecond", "radps", "rads", "radpersec", "rad/sec", "rad/seconds", "radians/s"), "rad/s"),
    **dict.fromkeys(("deg", "degs", "degree", "degrees", "grad", "º"), "°"),
    **dict.fromkeys(("1/min", "u/min", "r/min", "rev/min", "min-1", "min^-1", "min⁻¹", "umin"), "rpm"),
    **dict.fromkeys(("ohm", "ohms", "ω"), "Ω"),
    **{"kohm": "kΩ", "milliohm": "mΩ", "kiloohm": "kΩ", "megaohm": "MΩ"},
    **dict.fromkeys(("volt", "volts"), "V"),
    **dict.fromkeys(("ampere", "amperes", "amp", "amps"), "A"),
    **dict.fromkeys(("newton", "newtons"), "N"),
    **dict.fromkeys(("meter", "metre", "meters", "metres"), "m"),
    **dict.fromkeys(("degc", "°c", "celsius", "grad c", "deg c"), "°C"),
    **dict.fromkeys(("degf", "°f", "fahrenheit"), "°F"),
    **dict.fromkeys(("kelvin",), "K"),
    **dict.fromkeys(("percent", "pct", "prozent"), "%"),
    **dict.fromkeys(("-", "none", "dimensionless"), "1"),
    **dict.fromkeys(("inch", "inches"), "in"),
    **{"pascal": "Pa", "watt": "W", "joule": "J", "uv": "uV", "mv": "mV", "ma": "mA"},
}
DECIBEL = ("db", "decibel", "decibels")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_SAME = str.maketrans({"Ω": "Ω", "μ": "µ", "·": "*", "⋅": "*", "×": "*", "−": "-"})
_ATOM = re.compile(r"(.*?[^\d^*])(?:\^|\*\*)?(-?\d)?")


def parsed(text: str) -> Unit | None:
    """The unit that a text names, None when it is not known (or is dB, which is no factor)."""
    text = text.strip().translate(_SAME)
    known = _WORDS.get(text.lower())
    if known is not None and text not in _METRIC:
        text = known
    if not text or len(text) > 30:
        return None
    numerator, *denominators = text.split("/")
    result: Unit | None = Unit(1.0, NONE)
    for sign, part in ((1, numerator), *((-1, one) for one in denominators)):
        result = _product(result, part.strip().strip("()"), sign)
    return result


def _product(result: Unit | None, part: str, sign: int) -> Unit | None:
    for piece in re.split(r"(?<!\*)\*(?!\*)|\s+", part):
        found = _power(piece)
        if result is None or found is None:
            return None
        exponent = sign * found[1]
        ends = zip(result.dimension, found[0].dimension, strict=True)
        s, m, kg, a, k, rad = (one + exponent * other for one, other in ends)
        alone = result.dimension == NONE and exponent == 1
        result = Unit(
            result.factor * found[0].factor ** exponent, (s, m, kg, a, k, rad), found[0].offset if alone else 0.0
        )
    return result


def _power(piece: str) -> tuple[Unit, int] | None:
    if piece == "1":
        return _PLAIN["1"], 1
    found = _ATOM.fullmatch(piece.translate(_SUPERSCRIPTS))
    if found is None:
        return None
    unit = _symbol(found[1]) or _run_together(found[1])
    return None if unit is None else (unit, int(found[2] or 1))


def _symbol(text: str) -> Unit | None:
    text = text if text in _METRIC or text in _PLAIN else _WORDS.get(text.lower(), text)
    if text in _PLAIN:
        return _PLAIN[text]
    if text in _METRIC:
        return _METRIC[text]
    base = _METRIC.get(text[1:]) or (_METRIC["Ω"] if text[1:].lower() in ("ohm", "ohms") else None)
    if base is None or text[:1] not in PREFIXES:
        return None
    return Unit(PREFIXES[text[0]] * base.factor, base.dimension)


def _run_together(text: str) -> Unit | None:
    """Two symbols without a sign between them, such as Nm, Ah, Vs."""
    first, second = _symbol(text[:-1]), _symbol(text[-1:])
    if first is None or second is None or text[-2:-1] not in tuple("NAVWJ") or text[-1] not in "mshA":
        return None
    return _product(first, text[-1], 1)


def is_decibel(text: str) -> bool:
    """Whether a text names decibels."""
    return text.strip().lower() in DECIBEL


def is_unit(text: str) -> bool:
    """Whether a text names a unit that is known, decibels among them."""
    return is_decibel(text) or parsed(text) is not None


def conversion(given: str, wanted: str) -> tuple[float, float] | None:
    """(factor, offset) from values in one unit to values in another: factor·x + offset; None when they do not fit.

    Texts that are the same need not be known units.
    """
    if given.strip() == wanted.strip():
        return 1.0, 0.0
    one, other = parsed(given), parsed(wanted)
    if one is None or other is None or one.dimension != other.dimension:
        return None
    return one.factor / other.factor, (one.offset - other.offset) / other.factor
