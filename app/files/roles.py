"""What columns may be, by their names."""

import re
from collections.abc import Mapping
from types import MappingProxyType

from app.files import channel_columns, units
from app.files.column_names import ColumnName

# What can be said of a column on its own, as `columns` states it.
CHOICES = (
    "time",
    "input",
    "output",
    "reference",
    "frequency",
    "frequenciesRadPerSecond",
    "frequencyHz",
    "response",
    "responseRe",
    "responseIm",
    "magnitude",
    "phase",
    "variance",
    "deviation",
    "coherence",
    "averages",
    "repeat",
    "ignored",
)
UNIT_OF_CHOICE = {"frequenciesRadPerSecond": "rad/s", "frequencyHz": "Hz"}
ROLE_OF_CHOICE = {"frequenciesRadPerSecond": "frequency", "frequencyHz": "frequency"}


# Plain names, that is without case, spaces and marks, in the languages of instruments.
def _words(text: str, *more: str) -> tuple[str, ...]:
    return (*text.split(), *more)


NAMES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "time": _words("time t times zeit temps tiempo tempo elapsedtime testtime timestamp zeitstempel "),
        "counter": _words(
            "n k index sample samples sampleno samplenumber no nr number pt point points count counter messpunkt step ",
            "",
        ),
        "input": _words("input u inputs in eingang excitation stimulus eingangssignal inputdata "),
        "output": _words("output y outputs out ausgang ausgangssignal outputdata "),
        "reference": _words("reference setpoint sollwert referenz führungsgröße fuehrungsgroesse consigne "),
        "frequency": _words(
            "frequency frequencies freq freqs f fr frq frequenz frequenzen fréquence frecuencia frequenza frequência "
        ),
        "angular": _words(
            "omega w ω angularfrequency angularfrequencies radianfrequency kreisfrequenz pulsation pulsazione om "
        ),
        "response": _words(
            "response g h z frequencyresponse frf tf transferfunction impedance responsedata impedanz h1 h2 hv "
        ),
        "real": _words("responsere real re realpart realteil responsereal z' g' h' réel real(z) "),
        "imaginary": _words(
            "responseim imaginary imag im imagpart imaginarypart imaginärteil imaginaerteil responseimag zimg "
            'z" g" h" img react reactance '
        ),
        "magnitude": _words(
            "magnitude mag abs modulus module amplitude amp betrag gain |z| |g| |h| |y/u| zmod zabs "
            "amplitudengang absz absh absg magz magh magg impedance impedanz z h g verstärkung db dbh dbg "
            "ampl ratio "
        ),
        "phase": _words(
            "phase phi φ arg argument angle phasenwinkel phasengang zphz phz phaseangle phas ϕ theta θ winkel "
        ),
        "variance": _words("variance noisevariance responsevariance var varianz "),
        "deviation": _words("deviation standarddeviation std sd stddev stdev sigma σ standardabweichung "),
        "coherence": _words("coherence coh γ gamma cohxy kohärenz kohaerenz coherence2 gamma2 "),
        "averages": _words("averages navg nave numberofaverages avg avgs mittelungen "),
        "repeat": _words("repeat repeats repetition rep run trial wiederholung realization realisation "),
        "sample_time": _words(
            "sampletime sampletimeseconds ts dt samplingtime sampleinterval samplinginterval sampleperiod "
            "samplingperiod abtastzeit timestep tsample increment timeincrement deltat δt "
        ),
        "sample_rate": _words(
            "fs samplerate samplingrate samplefrequency samplingfrequency abtastrate samplespersecond "
        ),
        "period": _words("period periodsamples samplesperperiod "),
        "degrees_of_freedom": _words("variancedegreesoffreedom "),
    }
)
_ROLES: dict[str, list[str]] = {}
for _role, _names in NAMES.items():
    for _name in _names:
        _ROLES.setdefault(_name, []).append(_role)

_SECOND = units.parsed("s")
_RADIAN = units.parsed("rad")
_ANGULAR = units.parsed("rad/s")
_OF_RATES = ("frequency", "angular", "sample_rate")
# Words that say what a column is together with the letter of a response, such as Zreal, im Z, sd_G.
_WORD = {
    "real": re.compile(r"[zghys]?(?:re|real|realteil)[zghys]?"),
    "imaginary": re.compile(r"[zghys]?(?:im|imag|img|imaginary)[zghys]?"),
    "magnitude": re.compile(r"[zghys]?(?:mag|abs|mod|magnitude|gain|modulus)[zghys]?|db"),
    "phase": re.compile(r"[zghys]?(?:phase|phz|arg|angle)[zghys]?"),
    "deviation": re.compile(r"sd|std|stdev|stddev|sigma|deviation"),
    "variance": re.compile(r"var|variance"),
    "coherence": re.compile(r"coherence|coh"),
    "frequency": re.compile(r"freq|frequency|frequencies|frequenz"),
    "time": re.compile(r"time|zeit"),
}
_QUALIFIERS = {
    "part",
    "of",
    "response",
    "z",
    "g",
    "h",
    "y",
    "u",
    "the",
    "data",
    "test",
    "elapsed",
    "square",
    "measured",
}


def roles_of(name: ColumnName) -> list[str]:
    """What a column of this name may be, the likeliest first; nothing when its name is not understood.

    A unit that is known and is not one of such a quantity rules it out: "f (N)" is no frequency.
    """
    found = [role for role in _ROLES.get(name.plain, []) if _suits(role, name)]
    return found or [role for role in _by_words(name) if _suits(role, name)]


def entry_role(name: str) -> tuple[str, channel_columns.Entry] | None:
    """Meaning and entry of columns such as re_y1_u2."""
    return channel_columns.entry_of(re.sub(r"[\s_\-()/]", "", name).lower())


def _by_words(name: ColumnName) -> list[str]:
    """The single role that a word speaks of, where what else stands there qualifies it only or names the response."""
    kinds = ("deviation", "variance", "coherence", "real", "imaginary", "phase", "magnitude", "frequency", "time")
    words = name.words
    for role in kinds:
        hits = [word for word in words if _WORD[role].fullmatch(word)]
        others = [word for word in words if word not in hits and word not in _QUALIFIERS]
        if hits and (
            not others
            or (role not in ("frequency", "time") and all(len(word) <= 2 and word.isalpha() for word in others))
        ):
            return [role]
    return []


def _suits(role: str, name: ColumnName) -> bool:
    if units.is_decibel(name.unit):
        return role == "magnitude"
    unit = units.parsed(name.unit) if name.unit else None
    if unit is None:
        return role != "counter" or not name.unit
    if role in ("time", "sample_time"):
        return unit.dimension == getattr(_SECOND, "dimension", None)
    if role in _OF_RATES:
        return unit.dimension == getattr(_ANGULAR, "dimension", None)
    if role == "phase":
        return unit.dimension == getattr(_RADIAN, "dimension", None)
    return role not in ("counter", "period", "averages", "degrees_of_freedom")
