"""Numbers as a reader wants them: as many digits as they are worth."""

from math import floor, isfinite, log10


def significant(value: float, digits: int = 3) -> str:
    """A number to so many significant digits, without an exponent between 10⁻⁴ and 10⁶.

    Whole numbers keep all their places before the point; what is not finite is shown as a dash.
    """
    if not isfinite(value):
        return "–"
    if value == 0:
        return "0"
    magnitude = floor(log10(abs(float(f"{value:.{digits - 1}e}"))))
    if not -4 <= magnitude < 6:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        return f"{mantissa}·10{superscript(int(exponent))}".replace("-", "−")
    return f"{value:.{max(digits - 1 - magnitude, 0)}f}".replace("-", "−")


def estimate(value: float, deviation: float) -> str:
    """Value ± standard deviation, the latter to two significant digits and the former to the same place."""
    if not (isfinite(deviation) and deviation > 0):
        return significant(value)
    power = floor(log10(max(abs(value), deviation)))
    if not -4 <= power < 6:
        return f"({estimate(value / 10.0**power, deviation / 10.0**power)})·10{superscript(power)}"
    places = max(1 - floor(log10(float(f"{deviation:.1e}"))), 0)
    return f"{value:.{places}f} ± {deviation:.{places}f}".replace("-", "−")


def percent(share: float, digits: int = 3) -> str:
    """A share as a percentage."""
    return f"{significant(100 * share, digits)} %"


def probability(value: float) -> str:
    """A p-value; one that is too small for a number is said to be so."""
    return "< 10⁻³⁰⁰" if value == 0 else significant(value, 2)


def weight(share: float) -> str:
    """A share of evidence as a percentage, next to nothing and next to all told as such."""
    if share < 1e-3:
        return "< 0.1 %"
    return "> 99.9 %" if share > 1 - 1e-3 else f"{100 * share:.1f} %"


def point_label(point: tuple[float, ...], names: tuple[str, ...], units: tuple[str, ...]) -> str:
    """An operating point in words, such as v = 1.5 m/s."""
    parts = (f"{name} = {value:g} {unit}".rstrip() for name, value, unit in zip(names, point, units, strict=True))
    return ", ".join(parts).replace("-", "−")


def superscript(number: int) -> str:
    """A whole number in raised digits."""
    return str(number).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
