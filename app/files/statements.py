"""What is said beside a file: which column is what, in which unit, and what the plant's signals are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from app.files import units
from app.files.contents import FileError, Table
from app.files.roles import CHOICES, ROLE_OF_CHOICE, UNIT_OF_CHOICE
from identification.errors import MisuseError


@dataclass(frozen=True)
class Signal:
    """A channel of the plant: its name and unit."""

    name: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Said:
    """Statements about columns by their names: role, sign (None: as the name says) and unit; the plant's signals."""

    roles: Mapping[str, tuple[str, int | None]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    inputs: tuple[Signal, ...] = (Signal(),)
    outputs: tuple[Signal, ...] = (Signal(),)

    def signal(self, role: str) -> Signal:
        """The plant's only input or output; an empty one where it has several."""
        signals = self.inputs if role == "input" else self.outputs
        return signals[0] if len(signals) == 1 else Signal()

    def check(self, table: Table) -> None:
        """Raises FileError when a column that is spoken of is not there."""
        for name in (*self.roles, *self.units):
            table.column(name)


def said(
    columns: Sequence[str] = (),
    stated_units: Sequence[str] = (),
    inputs: Sequence[Signal] = (Signal(),),
    outputs: Sequence[Signal] = (Signal(),),
) -> Said:
    """The statements such as input=force, -responseIm=Zim, and units such as Frequency=Hz.

    Raises MisuseError when something is said twice, or a unit is not known.
    """
    pairs = [one.partition("=")[::2] for one in columns]
    meanings = [meaning for meaning, _ in pairs if meaning != "ignored"]
    if len({name for _, name in pairs}) < len(pairs) or len(set(meanings)) < len(meanings):
        raise MisuseError("each column and each meaning may be named once", "/columns")
    given: dict[str, str] = {}
    for one in stated_units:
        name, _, unit = one.rpartition("=")
        if name in given:
            raise MisuseError(f"the unit of {name[:40]!r} is stated twice", "/units")
        given[name] = _known(unit)
    roles: dict[str, tuple[str, int | None]] = {}
    for meaning, name in pairs:
        word = meaning.removeprefix("-")
        if word not in CHOICES:
            raise MisuseError(f"{word[:40]!r} is not among {', '.join(CHOICES)}", "/columns")
        roles[name] = (ROLE_OF_CHOICE.get(word, word), -1 if meaning.startswith("-") else None)
        if word in UNIT_OF_CHOICE:
            given.setdefault(name, UNIT_OF_CHOICE[word])
    return Said(roles, given, tuple(inputs), tuple(outputs))


def _known(unit: str) -> str:
    if not units.is_unit(unit):
        raise FileError(f"the unit {unit[:30]!r} is not known; write it like Hz, rad/s, ms, mm, V/A, dB, deg", "/units")
    return unit
