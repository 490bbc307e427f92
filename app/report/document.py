"""What a report is made of; tables serve the page and the terminal alike."""

from dataclasses import dataclass, field

import plotly.graph_objects as go


@dataclass(frozen=True)
class Table:
    """Rows of text under column heads; the first column names the row, further `text_columns` are text, not numbers."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    text_columns: int = 1


@dataclass(frozen=True, eq=False)
class Plot:
    """A figure, what it shows in one sentence, and the numbers behind it."""

    figure: go.Figure
    caption: str
    table: Table


@dataclass(frozen=True)
class Section:
    """A heading, paragraphs of plain text, then tables and plots in order."""

    title: str
    paragraphs: tuple[str, ...] = ()
    blocks: tuple[Table | Plot, ...] = ()


@dataclass(frozen=True)
class Fact:
    """One number that sums something up."""

    value: str
    meaning: str


@dataclass(frozen=True)
class Report:
    """A page: title, a sentence of introduction, the facts to remember, sections."""

    title: str
    introduction: str
    facts: tuple[Fact, ...] = ()
    sections: tuple[Section, ...] = field(default_factory=tuple)
