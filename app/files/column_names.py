"""Names of columns, taken apart: sign, what it is, unit.

Instruments write "Zre (Ohm)", "-Im(Z)/Ohm", "Time [ms]", "freq_hz", "t(s)", "neg. Phase / °", "Magnitude dB".
"""

import re
from dataclasses import dataclass

from app.files import units

MINUS = str.maketrans({**dict.fromkeys("−–﹣－", "-"), **dict.fromkeys("′’´`", "'"), **dict.fromkeys("″”", '"')})
_SIGN = re.compile(r"(?:\(?\s*-\s*|neg(?:ative)?\b\.?\s*|minus\s+)(?=[^\d\s])", re.IGNORECASE)
_SIGN_BEHIND = re.compile(r"\s*[*x·]\s*\(?\s*-\s*1\s*\)?\s*$")
_BRACKETS = re.compile(r"(.*?)\s*[\[({<]\s*([^\[\](){}<>]*?)\s*[\])}>]\s*$")
_SLASH = re.compile(r"(.+?)\s*/\s*([^/]+(?:/[^/]+)?)$")
_IN_WORDS = re.compile(r"(.+?)(?:,\s*|\s+in\s+)(\S+)$")
_LOOSE = re.compile(r"(.+?)[\s_\-.|]+([^\s_]+)$")
_CAMEL = re.compile(r"(.*?[a-z|')])(RadPerSecond|Seconds|[kKMm]?Hz|Hertz|Degrees|Deg|Rad|dB|Db|DB|[kmMµ]?Ohms?)$")
_FUNCTION = re.compile(r"(?:.*[\s_])?(re|im|real|imag|imaginary|abs|mag|magnitude|phase|arg|angle|db|std|var)$")


@dataclass(frozen=True)
class ColumnName:
    """A name taken apart.

    `sign`: −1 where the name says that the column holds minus the quantity; `base`: what is left; `unit`: "" where
    none stands in the name; `loose`: the unit is the last word of the name only, and may not have been meant as one.
    """

    sign: int
    base: str
    unit: str = ""
    loose: bool = False

    @property
    def plain(self) -> str:
        """The base without case, spaces and marks; primes of real and imaginary parts are kept."""
        return plain(self.base)

    @property
    def words(self) -> tuple[str, ...]:
        """The words of the base in lower case, also where capitals separate them."""
        spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", self.base.replace("dB", "db"))
        return tuple(re.findall(r"[^\W_]+['\"]*", spaced.lower()))


def plain(text: str) -> str:
    """A name without case, spaces and marks."""
    return re.sub(r"[\s_\-.()\[\]{}:#/²^]", "", text.translate(MINUS)).lower().replace("''", '"')


def taken_apart(name: str) -> ColumnName:
    """The parts of a name."""
    text = name.strip().strip("\ufeff").translate(MINUS).strip()
    sign = 1
    if found := _SIGN.match(text):
        sign, text = -1, text[found.end() :]
        text = (
            text[:-1] if found[0].startswith("(") and text.endswith(")") and text.count("(") < text.count(")") else text
        )
    if found := _SIGN_BEHIND.search(text):
        sign, text = -sign, text[: found.start()]
    base, unit, loose = _unit_of(text)
    return ColumnName(sign, base.strip() or text, unit, loose)


def _unit_of(text: str) -> tuple[str, str, bool]:
    if (found := _BRACKETS.fullmatch(text)) and found[1] and not _is_argument(found[1], found[2]):
        if not re.search(r"[:\d]", found[2]) or units.is_unit(found[2]):
            return found[1], found[2], False
        return text, "", False
    if (found := _SLASH.fullmatch(text)) and units.is_unit(found[2]):
        return found[1], found[2], False
    if (found := _IN_WORDS.fullmatch(text)) and units.is_unit(found[2]):
        return found[1], found[2], False
    if (found := _LOOSE.fullmatch(text)) and units.is_unit(found[2]) and not found[2].isdigit():
        return found[1], found[2], True
    if found := _CAMEL.fullmatch(text):
        return found[1], found[2], False
    return text, "", False


def _is_argument(before: str, inside: str) -> bool:
    """Whether brackets hold what a function is taken of, as in Im(Z), and not a unit."""
    if not _FUNCTION.fullmatch(before.lower()):
        return False
    if len(inside) == 1:
        return inside.isascii() and inside.isalpha() and inside not in "VA"
    return not units.is_unit(inside)
